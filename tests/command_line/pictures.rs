//! `--picture` and `--report`.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD as BASE64;
use tiny_skia::Pixmap;

use crate::programs::run;
use crate::workplace::{FAILED, USAGE, Workplace};

type Pixel = [u8; 3];

/// Rows of pixels.
fn pixels(path: &Path) -> Vec<Vec<Pixel>> {
    let picture = Pixmap::load_png(path).unwrap();
    let pixels: Vec<Pixel> =
        picture.pixels().iter().map(|pixel| [pixel.red(), pixel.green(), pixel.blue()]).collect();
    pixels.chunks(picture.width() as usize).map(<[Pixel]>::to_vec).collect()
}

/// The colours of at least a hundredth of the pixels, with their shares; one step of a channel is no other colour.
fn main_colors(rows: &[Vec<Pixel>]) -> BTreeMap<Pixel, f64> {
    let count = rows.iter().map(Vec::len).sum::<usize>() as f64;
    let mut shares: BTreeMap<Pixel, f64> = BTreeMap::new();
    for pixel in rows.iter().flatten() {
        let is_alike = |other: &&Pixel| (0..3).all(|channel| pixel[channel].abs_diff(other[channel]) <= 1);
        let known = shares.keys().find(is_alike).copied().unwrap_or(*pixel);
        *shares.entry(known).or_default() += 1.0 / count;
    }
    shares.retain(|_, share| *share >= 0.01);
    shares
}

const WHITE: Pixel = [255; 3];

/// The share of a picture of 500 x 400 pixels that a unit cube covers, of whose faces across x, y and z such shares are seen.
///
/// The shadow of a unit cube along a unit vector has the area of the sum of its components; its height is that of the unit vectors' shadows on
/// the picture's upward direction, here the shorter side, of which 4 % are free at both ends.
fn shadow(seen: glam::DVec3) -> f64 {
    let toward = glam::DVec3::new(0.55, -0.95, 0.62).normalize();
    let right = glam::DVec3::Z.cross(toward).normalize();
    let up = toward.cross(right);
    let sum = |vector: glam::DVec3| vector.abs().element_sum();
    let scale = (0.92 * 400.0 / sum(up)).min(0.92 * 500.0 / sum(right));
    sum(toward * seen) * scale * scale / (400.0 * 500.0)
}

#[test]
fn single_grain_is_a_cube_with_three_faces() {
    let workplace = Workplace::new();
    workplace.run("--seeds 1 -n 0 --picture cube.png --picture-size 500 400 --quiet");
    let rows = pixels(&workplace.path("cube.png"));
    assert_eq!((rows.len(), rows[0].len()), (400, 500));
    let colors = main_colors(&rows);
    assert_eq!(colors.len(), 4, "three faces on white: {colors:?}");

    let shadow = shadow(glam::DVec3::ONE);
    // Half the width of the outline and mixed colours at its rim are a hundredth.
    assert!((1.0 - colors[&WHITE] - shadow).abs() < 0.01, "{} {shadow}", colors[&WHITE]);
}

/// Half a cube shows half of its sides and all of its top, which lies in the plane.
#[test]
fn slices_leave_out_what_is_before_a_plane() {
    let workplace = Workplace::new();
    workplace.run("--seeds 1 -n 0 --picture half.png --picture-size 500 400 --slice z=0.5 --quiet");
    let colors = main_colors(&pixels(&workplace.path("half.png")));
    assert_eq!(colors.len(), 4, "three faces on white: {colors:?}");
    let half = shadow(glam::DVec3::new(0.5, 0.5, 1.0));
    assert!((1.0 - colors[&WHITE] - half).abs() < 0.01, "{} {half}", colors[&WHITE]);

    // A cut through the left grain alone leaves nothing of the right one, and shows its inside.
    workplace.put("two.csv", "0.25, 0.5, 0.5\n0.75, 0.5, 0.5\n");
    let shades = |at: f64| {
        let run = format!(
            "--seeds-file two.csv --relax 0 -n 0 --picture two.png --picture-size 500 400 --slice x={at} --quiet"
        );
        workplace.run(&run);
        main_colors(&pixels(&workplace.path("two.png"))).len()
    };
    assert_eq!([shades(0.4), shades(0.6)], [4, 6]);
}

#[test]
fn background_may_be_transparent() {
    let workplace = Workplace::new();
    workplace.put("two.csv", "0.25, 0.5\n0.75, 0.5\n");
    for more in ["--seeds 3", "--dim 2 --box 1 1 --seeds-file two.csv", "--seeds 3 --color-by diameter"] {
        let size = "-n 0 --relax 0 --picture-size 200 200 --quiet";
        workplace.run(&format!("{more} {size} --picture a.png --transparent"));
        workplace.run(&format!("{more} {size} --picture b.png"));
        let [clear, white] = ["a.png", "b.png"].map(|name| Pixmap::load_png(workplace.path(name)).unwrap());
        let mut counts = [0; 3];
        for (clear, white) in clear.pixels().iter().zip(white.pixels()) {
            counts[usize::from(clear.alpha() > 0) + usize::from(clear.alpha() == 255)] += 1;
            // White shows through what is drawn as far as that is transparent.
            let behind = u16::from(255 - clear.alpha());
            for [clear, white] in
                [[clear.red(), white.red()], [clear.green(), white.green()], [clear.blue(), white.blue()]]
            {
                assert!(
                    (u16::from(clear) + behind).abs_diff(u16::from(white)) <= 2,
                    "{clear} {white} {more}"
                );
            }
        }
        assert!(counts[0] > 1000 && counts[1] > 10 && counts[2] > 10_000, "{counts:?} {more}");
    }
}

/// A ball of one grain has no edges.
#[test]
fn facets_of_curved_domains_are_no_boundaries() {
    let workplace = Workplace::new();
    workplace.run("--domain sphere --seeds 1 -n 0 --picture ball.png --quiet");
    let dark = |name: &str| {
        let rows = pixels(&workplace.path(name));
        rows.iter().flatten().filter(|pixel| pixel.iter().all(|channel| *channel < 60)).count()
    };
    assert_eq!(dark("ball.png"), 0);
    // A drum has its two rims, of which half of the lower is hidden.
    workplace.run("--domain cylinder --seeds 1 -n 0 --picture drum.png --quiet");
    assert!((1000..20_000).contains(&dark("drum.png")), "{}", dark("drum.png"));
}

#[test]
fn colors_show_sizes() {
    let workplace = Workplace::new();
    workplace.put("two.csv", "0.25, 0.5, 0.5\n0.4, 0.5, 0.5\n");
    workplace.run("--seeds-file two.csv --relax 0 -n 0 --picture sizes.png --picture-size 500 400 --color-by diameter --quiet");
    // Viridis goes from (68, 1, 84) to (253, 231, 37); a face in shade has the same colour, darker.
    let colors = main_colors(&pixels(&workplace.path("sizes.png")));
    let is_shade_of = |pixel: &&Pixel, [r, g, b]: [f64; 3]| {
        let brightness = f64::from(pixel[0]) / r;
        brightness <= 1.0
            && (f64::from(pixel[1]) - brightness * g).abs() < 2.0
            && (f64::from(pixel[2]) - brightness * b).abs() < 2.0
    };
    let count = |color| colors.keys().filter(|pixel| is_shade_of(pixel, color)).count();
    assert_eq!([count([253.0, 231.0, 37.0]), count([68.0, 1.0, 84.0])], [3, 2], "{colors:?}");
}

#[test]
fn plane_is_drawn_from_above() {
    let workplace = Workplace::new();
    workplace.put("two.csv", "0.25, 0.5\n0.75, 0.5\n");
    let arguments = "--seeds-file two.csv --dim 2 --box 1 1 -n 0 --picture-size 200 200 --quiet";
    workplace.run(&format!("{arguments} --picture whole.png"));
    let rows = pixels(&workplace.path("whole.png"));
    let [left, right] = [rows[100][50], rows[100][150]];
    assert!(left != right && left != WHITE && right != WHITE, "{left:?} {right:?}");
    let colors = main_colors(&rows);
    // Each half but for the lines, in a square without its margins.
    for color in [left, right] {
        assert!((colors[&color] - 0.92 * 0.92 / 2.0).abs() < 0.02, "{colors:?}");
    }
    assert_eq!(rows[100][2], WHITE);

    // Apart, there is white between them.
    workplace.run(&format!("{arguments} --picture apart.png --explode 1"));
    let rows = pixels(&workplace.path("apart.png"));
    assert_eq!((rows[100][100], rows[100][20] == WHITE, rows[100][180] == WHITE), (WHITE, false, false));
}

#[test]
fn pictures_do_not_depend_on_threads() {
    let workplace = Workplace::new();
    for threads in [1, 2] {
        workplace.run(&format!(
            "--seeds 30 -n 1 --explode 0.3 --picture {threads}.png --picture-size 500 400 --threads {threads} --quiet"
        ));
    }
    assert!(workplace.bytes("1.png") == workplace.bytes("2.png"));
}

/// Cubes along the sample's axes are red; the key at the right has red, green and blue corners, and letters.
#[test]
fn directions_of_crystals_have_colours_and_a_key() {
    let workplace = Workplace::new();
    workplace.put("cube.csv", "phi1,Phi,phi2\n0,0,0\n");
    let cube = "--seeds 2 -n 0 --relax 0 --texture cube.csv --quiet";
    workplace.run(&format!("{cube} --picture a.png --picture-size 400 300 --color-by ipf-z"));
    let (mut reds, mut keys) = (0, [0; 3]);
    for (column, pixel) in pixels(&workplace.path("a.png")).iter().flat_map(|row| row.iter().enumerate()) {
        reds += usize::from(column < 200 && pixel[0] > 80 && pixel[1] == 0 && pixel[2] == 0);
        for (corner, count) in keys.iter_mut().enumerate() {
            let is_pure = (0..3).all(|channel| (channel == corner) == (pixel[channel] > 150));
            *count += usize::from(column > 250 && is_pure);
        }
    }
    assert!(reds > 10_000, "{reds}");
    assert!(keys.iter().all(|count| *count > 20), "{keys:?}");
}

#[test]
fn keys_to_colours_give_way_in_tiny_pictures() {
    let workplace = Workplace::new();
    for (size, what) in
        [("16 16", "ipf-z"), ("60 16", "phase"), ("16 200", "diameter"), ("40 40", "disorientation")]
    {
        workplace.run(&format!(
            "--seeds 3 -n 0 --relax 0 --texture random --phase iron:1 --picture {what}.png --picture-size {size} --color-by {what} --quiet"
        ));
        let rows = pixels(&workplace.path(&format!("{what}.png")));
        let [width, height] = [rows[0].len(), rows.len()].map(|side| side.to_string());
        assert_eq!(format!("{width} {height}"), size);
    }
}

/// Boundaries are coloured, not grains: two crystals turned by 45 degrees about one axis.
#[test]
fn disorientations_colour_boundaries() {
    let workplace = Workplace::new();
    workplace.put("seeds.csv", "0.25,0.5\n0.75,0.5\n");
    workplace.put("turned.csv", "phi1,Phi,phi2\n0,0,0\n45,0,0\n");
    let run = "--dim 2 --seeds-file seeds.csv -n 0 --relax 0 --texture turned.csv --quiet";
    workplace.run(&format!("{run} --picture a.png --picture-size 400 300 --color-by disorientation"));
    let rows = pixels(&workplace.path("a.png"));
    // The end of Viridis, in the line between the grains; the key has it in a row.
    let yellow = |column: &usize| rows.iter().filter(|row| row[*column] == [253, 231, 37]).count();
    let columns: Vec<usize> = (0..400).filter(|column| yellow(column) > 100).collect();
    assert!(!columns.is_empty() && columns.iter().all(|column| *column < 300), "{columns:?}");
}

#[test]
fn mistakes_about_pictures_are_named() {
    let workplace = Workplace::new();
    for (arguments, message) in [
        (
            "--picture a.jpg",
            "invalid value 'a.jpg' for '--picture <PATH.png>': unknown extension; name the file *.png",
        ),
        (
            "--report a.htm",
            "invalid value 'a.htm' for '--report <PATH.html>': unknown extension; name the file *.html",
        ),
        (
            "--picture a.png --picture-size 0 5",
            "invalid value '0' for '--picture-size <W> <H>': give a whole number from 16 to 16384",
        ),
        (
            "--picture a.png --explode -1",
            "invalid value '-1' for '--explode <X>': give a number from 0 (whole) to 10",
        ),
        (
            "--picture a.png --slice w=1",
            "invalid value 'w=1' for '--slice <AXIS=X>': give an axis and a coordinate, as z=0.5",
        ),
        ("--picture a.png --slice z=2", "--slice z=2 does not meet the box, which goes from 0 to 1 along z"),
        ("--picture a.png --dim 2 --slice z=0", "--slice cuts grains in space; leave it out with --dim 2"),
        ("--no-mesh --picture a.png", "the argument '--no-mesh' cannot be used with '--picture <PATH.png>'"),
        (
            "--picture a.png --color-by ipf-z",
            "--color-by ipf-z shows orientations; give the grains some, such as --texture random",
        ),
        (
            "--picture a.png --color-by disorientation",
            "--color-by disorientation shows orientations; give the grains some, such as --texture random",
        ),
    ] {
        workplace.refuses(arguments, USAGE, message);
    }
    workplace.refuses(
        "--report no/a.html",
        FAILED,
        "no/a.html: no directory no; create it or choose another path",
    );
    workplace.refuses(
        "--picture no/a.png",
        FAILED,
        "no/a.png: no directory no; create it or choose another path",
    );
}

/// The network in a report.
/// The head of the network in a page, and how many words of four bytes each of its arrays has.
fn embedded_network(page: &str) -> (serde_json::Value, impl Fn(&str) -> u64) {
    let (_, after) = page.split_once("<script type=\"text/plain\" id=\"network\">").unwrap();
    let bytes = BASE64.decode(after.split_once("</script>").unwrap().0).unwrap();
    let length = u32::from_le_bytes(bytes[..4].try_into().unwrap()) as usize;
    let head: serde_json::Value = serde_json::from_slice(&bytes[4..4 + length]).unwrap();
    let arrays = head["arrays"].clone();
    let count = move |name: &str| {
        let found = arrays.as_array().unwrap().iter().find(|array| array["name"] == name).unwrap();
        found["words"].as_u64().unwrap()
    };
    (head, count)
}

/// The number of triangles of all boundaries.
fn triangles(head: &serde_json::Value) -> u64 {
    let boundaries = head["boundaries"].as_array().unwrap();
    boundaries.iter().map(|boundary| boundary["triangles"].as_u64().unwrap()).sum()
}

#[test]
fn report_holds_the_network_and_the_run() {
    let workplace = Workplace::new();
    let said = workplace.run("--seeds 20 -n 2 --report grains.html");
    let page = String::from_utf8(workplace.bytes("grains.html")).unwrap();
    assert!(
        !page.contains("{{") || page.find("{{") > page.find("var THREE"),
        "all places of the template are filled"
    );
    for line in said.lines().filter(|line| line.starts_with("boundaries") || line.starts_with("angles")) {
        let value = line.split_once("  ").unwrap().1.trim();
        assert!(page.contains(&format!("<td>{value}</td>")), "{value}");
    }
    assert!(page.contains("<code>grainsmooth ") && page.contains("--seeds 20"));

    let (head, count) = embedded_network(&page);
    assert_eq!(count("corners"), 3 * triangles(&head));
    let boundaries = head["boundaries"].as_array().unwrap();
    let vertices: u64 = boundaries.iter().map(|boundary| boundary["vertices"].as_u64().unwrap()).sum();
    assert_eq!((count("position"), count("normal")), (3 * vertices, vertices));
    assert_eq!(head["ids"].as_array().unwrap().len(), 20);
    let names: Vec<&str> =
        head["columns"].as_array().unwrap().iter().map(|column| column["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["volume", "neighbors", "surface area", "equivalent diameter"]);
    // The cube, in units of its side, from its middle.
    assert_eq!((&head["middle"], &head["unit"]), (&serde_json::json!([0.5, 0.5, 0.5]), &1.0.into()));
    assert_eq!(page.matches("<svg").count(), 4);
}

/// Each figure stands in the page and in the summary for programs, with what came of it.
#[test]
fn report_tells_what_was_asked_for_and_reached() {
    let workplace = Workplace::new();
    let texture = "goss(10)*0.4+random*0.6";
    workplace.run(&format!(
        "--seeds 80 -n 0 --relax 0 --diameters lognormal(mean=2,cv=0.3) --phase a:0.8,texture={texture} --phase b:0.2,texture=random --report r.html --json-summary run.json --quiet"
    ));
    let page = String::from_utf8(workplace.bytes("r.html")).unwrap();
    let run = workplace.json("run.json");
    let rows = run["asked_and_reached"].as_array().unwrap();
    let row =
        |what: &str| rows.iter().find(|row| row["what"] == what).unwrap_or_else(|| panic!("{what} in {run}"));
    for (what, asked, error) in [
        ("coefficient of variation of diameters", 0.3, 0.02),
        // Diameters of phases change a little, so that these have their shares.
        ("largest difference from the distribution function, by number", 0.0, 0.01),
        ("largest relative error of a grain's volume", 0.0, 1e-10),
        ("share of the volume, a", 0.8, 1e-10),
        ("share of the volume, b", 0.2, 1e-10),
        ("share of the volume, goss(10), a", 0.4, 0.02),
        ("share of the volume, random, b", 1.0, 1e-12),
    ] {
        let [found, reached] = ["asked", "reached"].map(|key| row(what)[key].as_f64().unwrap());
        assert!((found - asked).abs() < 1e-12 && (reached - asked).abs() < error, "{what}: {reached}");
        assert!(page.contains(&format!("<th>{what}</th><td>{asked}</td>")), "{what}");
    }
    let mean = row("mean diameter");
    let [reached, found] =
        [&mean["reached"], &run["equivalent_diameter"]["mean"]].map(|mean| mean.as_f64().unwrap());
    assert!((reached / found - 1.0).abs() < 1e-12, "{mean}");
}

#[test]
fn report_in_the_plane_holds_a_picture() {
    let workplace = Workplace::new();
    workplace.run("--seeds 20 --dim 2 --report grains.html --quiet");
    let page = String::from_utf8(workplace.bytes("grains.html")).unwrap();
    let (_, after) = page.split_once("src=\"data:image/png;base64,").unwrap();
    let picture = BASE64.decode(after.split_once('"').unwrap().0).unwrap();
    assert_eq!(Pixmap::decode_png(&picture).unwrap().width(), 1200);
    assert_eq!(page.matches("<svg").count(), 4);
}

/// The screenshot stays in the folder for the tests' files, for people to look at.
#[test]
fn browser_shows_the_grains_of_a_report() {
    let workplace = Workplace::new();
    workplace.run("--seeds 20 -n 2 --report grains.html --quiet");
    let page = workplace.path("grains.html");
    let screenshot = Path::new(env!("CARGO_TARGET_TMPDIR")).join("report.png");
    let browse = |arguments: &[&str]| {
        let mut browser = Command::new("chromium");
        browser.args([
            "--headless",
            "--no-sandbox",
            "--enable-unsafe-swiftshader",
            "--enable-logging=stderr",
        ]);
        // The page draws once and is done: no time of the clock passes.
        browser.args(["--window-size=1000,1200", "--virtual-time-budget=10000"]).args(arguments).arg(&page);
        run("browser_shows_the_grains_of_a_report", &mut browser)
    };
    let Some(output) = browse(&["--dump-dom"]) else { return };
    let said = String::from_utf8_lossy(&output.stderr);
    // Taking a screenshot without a graphics card is slow, of which the driver tells.
    let complaints =
        said.lines().filter(|line| line.contains("CONSOLE") && !line.contains("GL Driver Message"));
    let complaints: Vec<&str> = complaints.collect();
    assert!(complaints.is_empty(), "{complaints:?}");

    let (head, _) = embedded_network(&String::from_utf8(workplace.bytes("grains.html")).unwrap());
    let shown = format!(
        "id=\"view\" data-shown=\"20\" data-triangles=\"{}\" data-coloring=\"different\"",
        triangles(&head)
    );
    assert!(String::from_utf8_lossy(&output.stdout).contains(&shown), "{shown}");

    browse(&[&format!("--screenshot={}", screenshot.display())]).unwrap();
    let rows = pixels(&screenshot);
    // Within the view, which begins under the controls, saturated colours are those of grains.
    let is_colored = |pixel: &&Pixel| pixel.iter().max().unwrap() - pixel.iter().min().unwrap() > 60;
    let colored = rows[150..650].iter().flatten().filter(is_colored).count();
    assert!(colored > 500 * 1000 / 10, "{colored} of 500000 pixels are coloured");
}
