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
pub(crate) const SCRIPTS: [(&str, &str); 10] = [
    script!("packed.js"),
    script!("stage.js"),
    script!("panel.js"),
    script!("colors.js"),
    script!("network.js"),
    script!("grains.js"),
    script!("server.js"),
    script!("shape.js"),
    script!("edit.js"),
    script!("main.js"),
];

/// The part of three.js that draws.
pub(crate) const THREE: &str = include_str!("../../assets/three.min.js");

/// How the page looks.
pub(crate) const PAGE_STYLE: &str = include_str!("../../assets/page/page.css");

/// The page itself, with the secret that its commands need.
pub(super) fn page(secret: &str) -> Answer {
    let text = include_str!("../../assets/page/page.html").replace("{{secret}}", secret);
    Answer::new(HTML, text)
}

/// What follows a link. Its cookie is for requests of this site alone, and a redirection would count as one of whoever showed the link; a page
/// that goes on by itself does not.
pub(super) fn entrance(cookie: String) -> Answer {
    let text = "<!DOCTYPE html><meta charset=utf-8><title>grainsmooth</title><meta http-equiv=refresh content=\"0;url=/\">";
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
