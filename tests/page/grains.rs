//! Grains in the browser.

use serde_json::json;

use super::browser::Browser;
use super::served::Served;

fn make(directory: &std::path::Path, arguments: &str) {
    let made = std::process::Command::new(env!("CARGO_BIN_EXE_grainsmooth"))
        .args(arguments.split(' '))
        .current_dir(directory)
        .status()
        .unwrap();
    assert!(made.success());
}

fn grains(directory: &std::path::Path) {
    make(directory, "--seeds 12 -n 1 -o a.vtp --texture random --arrays --quiet");
    let collection = "<VTKFile><Collection><DataSet timestep=\"0\" file=\"a.vtp\"/><DataSet timestep=\"1.5\" file=\"a.vtp\"/></Collection></VTKFile>";
    std::fs::write(directory.join("a.pvd"), collection).unwrap();
}

/// Checks that what the status tells of the grain that is pointed at is what the file holds.
fn assert_told(browser: &mut Browser, served: &Served, what: &str) {
    let id = browser.value("document.getElementById('view').dataset.hovered");
    let said = browser.value("document.getElementById('status').textContent");
    let file = std::fs::read(served.path("a.vtp")).unwrap();
    let volume = grainsmooth::vtk::field_numbers(&file, "Volumes").unwrap()
        [id.as_str().unwrap().parse::<usize>().unwrap()];
    let behind = said.as_str().unwrap().split(&format!(" · {what} ")).nth(1).unwrap().to_owned();
    let told: f64 = behind.split(' ').next().unwrap().parse().unwrap();
    assert!((told / volume - 1.0).abs() < 1e-3, "{said} {volume}");
}

/// Grains in the plane, with lines and without: areas are those of the file, and no neighbours are alike.
#[test]
fn grains_of_the_plane_are_shown() {
    let Some(mut browser) = Browser::new("the plane in the browser") else { return };
    let served = Served::new("view a.vtp", |directory| {
        make(directory, "--dim 2 --seeds 20 -n 2 -o a.vtp --arrays --quiet");
    });
    browser.open(&served.link);
    let dataset = "document.getElementById('view').dataset";
    assert_eq!(browser.value(&format!("{dataset}.shown")), json!("20"));
    assert_eq!(browser.value("document.getElementById('status').textContent"), json!("20 grains"));
    for at in [[700.0, 250.0], [780.0, 400.0]] {
        browser.hover(at);
        assert_told(&mut browser, &served, "area");
    }
    // All of the square is filled.
    let area =
        browser.value("page.head.facts.reduce((sum, grain) => sum + grain.volume, 0)").as_f64().unwrap();
    assert!((area - 1.0).abs() < 1e-9, "{area}");
    browser.leave_screenshot("plane.png");
    browser.set("explode", "0.3");
    browser.leave_screenshot("plane_apart.png");
    browser.set("explode", "0");
    let ways = browser.value("document.getElementById('coloring').options.length").as_u64().unwrap();
    for way in 1..ways {
        let value = browser.value(&format!("document.getElementById('coloring').options[{way}].value"));
        browser.set("coloring", value.as_str().unwrap());
        browser.wait(&format!("{dataset}.coloring === {value}"));
        assert_ne!(browser.value("document.querySelector('.legend').textContent"), json!(""));
    }
    browser.leave_screenshot("plane_lines.png");
    browser.assert_quiet();
}

#[test]
fn grains_are_sliced_isolated_and_coloured() {
    let Some(mut browser) = Browser::new("grains in the browser") else { return };
    let served = Served::new("view a.pvd", grains);
    browser.open(&served.link);
    let shown = |browser: &mut Browser| browser.value("document.getElementById('view').dataset.shown");
    assert_eq!(shown(&mut browser), json!("12"));
    let middle = [750.0, 330.0];
    browser.click(middle);
    let dataset = "document.getElementById('view').dataset";
    let id = browser.value(&format!("{dataset}.selected"));
    assert_eq!(browser.value(&format!("{dataset}.hovered")), id);
    assert_told(&mut browser, &served, "volume");
    browser.press("isolate");
    assert_eq!(shown(&mut browser), json!("1"));
    browser.leave_screenshot("isolated.png");
    browser.press("all");
    browser.press("hide");
    assert_eq!(shown(&mut browser), json!("11"));
    browser.press("all");
    // Caps are of grains that the plane cuts: what is seen there is not what was seen before.
    browser.value("document.getElementById('turned').click()");
    browser.set("axis", "y");
    browser.set("depth", "0.3");
    browser.hover([760.0, 330.0]);
    assert_ne!(browser.value(&format!("{dataset}.hovered")), json!(""));
    browser.leave_screenshot("sliced.png");
    browser.set("axis", "");
    let whole = browser.value(&format!("{dataset}.triangles"));
    browser.set("explode", "0.4");
    assert_ne!(browser.value(&format!("{dataset}.triangles")), whole);
    browser.leave_screenshot("exploded.png");
    // Each way of colouring has its legend, but the first.
    let ways = browser.value("document.getElementById('coloring').options.length").as_u64().unwrap();
    assert!(ways > 12, "{ways}");
    for way in 1..ways {
        let value = browser.value(&format!("document.getElementById('coloring').options[{way}].value"));
        browser.set("coloring", value.as_str().unwrap());
        browser.wait(&format!("{dataset}.coloring === {value}"));
        assert_ne!(browser.value("document.querySelector('.legend').textContent"), json!(""));
    }
    browser.set("step", "1");
    browser.wait("window.page.head.step === 1");
    assert_eq!(browser.value("document.querySelector('output').textContent"), json!("time 1.5"));
    browser.drag(middle, [850.0, 300.0]);
    browser.assert_quiet();
}
