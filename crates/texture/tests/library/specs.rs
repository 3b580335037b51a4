//! Textures in words.

use texture::{Component, Texture};

fn shares(text: &str) -> Vec<(f64, String)> {
    let texture: Texture = text.parse().expect("the text is a texture");
    texture.components().map(|(_, share, name)| (share, name.to_owned())).collect()
}

#[test]
fn sums_weights_and_names_are_read() {
    assert_eq!(shares("random"), [(1.0, "random".to_owned())]);
    let both = [(0.3, "cube(5)".to_owned()), (0.7, "random".to_owned())];
    assert_eq!(shares("cube(5)*0.3+random*0.7"), both);
    assert_eq!(shares(" 3 * cube(5) + 7*random "), both);
    assert_eq!(shares("copper(8)+S(8)+Brass(8)+goss(8)").len(), 4);
    assert_eq!(shares("Rotated_Cube(8) + rotated goss(8)")[1], (0.5, "rotated goss(8)".to_owned()));
}

#[test]
fn each_way_of_writing_an_orientation_gives_the_same() {
    let mode = |text: &str| {
        let texture: Texture = text.parse().unwrap();
        let (component, ..) = texture.components().next().unwrap();
        match component {
            Component::Peak { mode, .. } => mode.quaternion(),
            _ => panic!("{text} is no peak"),
        }
    };
    for text in ["{011}<100>(10)", "{0 1 1}<1 0 0>(10)", "euler(0 45 0, 10)", "euler(0,45,0,10)"] {
        let off =
            mode(text).into_iter().zip(mode("GOSS(10)")).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off < 1e-15, "{text}");
    }
    let fiber = |text: &str| text.parse::<Texture>().unwrap().components().next().unwrap().0.clone();
    assert_eq!(fiber("gamma(10)"), fiber("fiber(111||nd,10)"));
    assert_eq!(fiber("fibre(0001 || z, 5)"), fiber("basal(5)"));
}

#[test]
fn what_is_no_texture_is_refused_with_a_remedy_that_works() {
    // The text, what its message says, and a remedy named there.
    for (text, says, remedy) in [
        ("gos(10)", "'gos' is unknown; did you mean 'goss'?", "goss(10)"),
        ("goss", "'goss' needs a halfwidth in degrees: goss(10)", "goss(10)"),
        ("goss()", "the halfwidth '' of 'goss' is not a number of degrees; write 10", "goss(10)"),
        ("goss(x)", "the halfwidth 'x' of 'goss'", "goss(10)"),
        ("goss(200)", "a halfwidth of 200 degrees is not between 0.01 and 90", "random"),
        ("goss(-1)", "a halfwidth of -1 degrees is not between", "goss(0)"),
        ("random(5)", "random takes no argument", "random"),
        ("cube(5)*0.3+random", "'random' has no weight", "cube(5)*0.3+random*0.5"),
        ("cube(5)*0", "the weight 0 in 'cube(5)*0' is not positive", "cube(5)"),
        ("cube(5)*-1", "the weight -1 in", "cube(5)"),
        ("cube(5)*random", "multiplies two components; add them with +", "cube(5)+random"),
        ("0.3", "'0.3' has no component; write random", "random"),
        ("", "write random", "random"),
        ("cube(5)+", "nothing stands on one side of a '+'", "cube(5)+random"),
        ("cube(5", "a bracket is not closed; add it", "cube(5)"),
        ("cube 5)", "')' closes nothing", "cube(5)"),
        ("cube(5)random", "goes on after its last bracket", "cube(5)+random"),
        ("fiber(111,10)", "fiber(111||z, 10)", "fiber(111||z, 10)"),
        ("fiber(111||w,10)", "'w' is not a sample direction; give x, y, z", "fiber(111||x,10)"),
        ("fiber(11||z,10)", "'11' is not a direction; give three indices", "fiber(111||z,10)"),
        ("fiber(000||z,10)", "'000' has no direction", "fiber(001||z,10)"),
        ("euler(10 20 30)", "needs three angles and a halfwidth", "euler(30 45 60, 10)"),
        ("euler", "write the angles and a halfwidth", "euler(30 45 60, 10)"),
        ("{011}<111>(10)", "the direction does not lie in the plane", "{011}<11-1>(10)"),
        ("{011}(10)", "write it as {112}<-1-11>(10)", "{112}<-1-11>(10)"),
        ("texture.ori", "'texture.ori' is unknown; there are cube", "cube(5)"),
    ] {
        let error = text.parse::<Texture>().expect_err(text).to_string();
        assert!(error.starts_with(&format!("texture '{text}': ")), "{error}");
        assert!(error.contains(says), "{text}: {error}");
        assert!(remedy.parse::<Texture>().is_ok(), "{remedy}");
    }
}
