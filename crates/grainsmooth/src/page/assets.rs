//! The files of the page, all of them in the program: no request names a path of the disk.

use super::answer::Answer;

const HTML: &str = "text/html; charset=utf-8";
const SCRIPT: &str = "text/javascript; charset=utf-8";
const STYLE: &str = "text/css; charset=utf-8";

/// A script of the page under its name.
macro_rules! script {
    ($name:literal) => {
        ($name, include_str!(concat!("../../assets/page/", $name)))
    };
}

/// The modules of the page, each after those that it imports.
pub(crate) const SCRIPTS: [(&str, &str); 11] = [
    script!("packed.js"),
    script!("stage.js"),
    script!("panel.js"),
    script!("colors.js"),
    script!("network.js"),
    script!("grains.js"),
    script!("server.js"),
    script!("refine.js"),
    script!("shape.js"),
    script!("edit.js"),
    script!("main.js"),
];

/// The part of three.js that draws.
pub(crate) const THREE: &str = include_str!("../../assets/three.min.js");

/// How the page looks.
pub(crate) const PAGE_STYLE: &str = include_str!("../../assets/page/page.css");

/// The modules that draw grains, as one script for a page that stands alone: each name is of one of them only.
pub(crate) fn report_scripts() -> String {
    let names = ["packed.js", "stage.js", "panel.js", "colors.js", "network.js", "grains.js"];
    let modules = SCRIPTS.iter().filter(|(name, _)| names.contains(name)).map(|(_, text)| *text);
    let lines = modules.chain([include_str!("../../assets/page/report.js")]).flat_map(str::lines);
    let own = lines.filter(|line| !line.starts_with("import ") && !line.starts_with("export {"));
    own.flat_map(|line| [line.strip_prefix("export ").unwrap_or(line), "\n"]).collect()
}

/// The page itself, with the secret that its commands need.
pub(super) fn page(secret: &str) -> Answer {
    let text = include_str!("../../assets/page/page.html").replace("{{secret}}", secret);
    Answer::new(HTML, text)
}

/// What follows a link. Its cookie is for requests of this site alone, and a redirection would count as one of whoever showed the link; a page
/// that goes on by itself does not.
pub(super) fn entrance(cookie: String) -> Answer {
    let text = "<!DOCTYPE html><meta charset=utf-8><title>grainsmooth</title><link rel=icon href=data:,><meta http-equiv=refresh content=\"0;url=/\">";
    Answer { cookie: Some(cookie), ..Answer::new(HTML, text) }
}

/// A file of the page.
pub(super) fn file(path: &str) -> Option<Answer> {
    let name = path.strip_prefix('/')?;
    match name {
        "three.js" => Some(Answer::new(SCRIPT, THREE)),
        "page.css" => Some(Answer::new(STYLE, PAGE_STYLE)),
        _ => SCRIPTS.iter().find(|(known, _)| *known == name).map(|(_, text)| Answer::new(SCRIPT, *text)),
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn modules_of_reports_share_no_names() {
        let scripts = report_scripts();
        let mut names = BTreeSet::new();
        for line in scripts.lines() {
            assert!(!line.starts_with("import") && !line.starts_with("export"), "{line}");
            let words: Vec<&str> = line.trim_start_matches("async ").split([' ', '(', '=', ',']).collect();
            if ["const", "let", "function", "class"].contains(&words[0]) {
                assert!(names.insert(words[1]), "{line}");
            }
        }
        assert!(names.contains("GrainsPage") && names.contains("markRow"), "{names:?}");
    }
}
