//! Directions written as indices.

use glam::DVec3;

/// Reads three indices such as `110`, `-1-12`, `1 -1 0` or `4 4 11`: a unit direction along the crystal's or the sample's own axes. Of four
/// (hexagonal, plane normals with l = 0, or 0001) the third is minus the sum of the first two.
///
/// # Errors
/// What is wrong, and what to write instead.
pub(crate) fn direction(text: &str) -> Result<DVec3, String> {
    let indices = indices(text).ok_or_else(|| {
        format!("'{text}' is not a direction; give three indices, such as 111, -1-12 or '4 4 11'")
    })?;
    let direction = match indices[..] {
        [x, y, z] => DVec3::new(x, y, z),
        [h, k, i, _] if h + k + i != 0.0 => {
            return Err(format!(
                "the first three of the four indices '{text}' do not add up to 0; the third is {}",
                -h - k
            ));
        }
        [0.0, 0.0, _, l] => l * DVec3::Z,
        // The normals of (10-10) and (01-10) stand at 30 and 90 degrees from the axis a along x.
        [h, k, _, 0.0] => DVec3::new(0.75_f64.sqrt() * h, 0.5 * h + k, 0.0),
        [..] => {
            return Err(format!(
                "the direction of '{text}' depends on the crystal's axis ratio; give its three components in perpendicular axes, c along z"
            ));
        }
    };
    direction.try_normalize().ok_or_else(|| format!("'{text}' has no direction; give an index other than 0"))
}

/// Three or four numbers: between spaces or commas any, otherwise single digits with signs.
fn indices(text: &str) -> Option<Vec<f64>> {
    let words: Vec<&str> = text.split([' ', ',', '\t']).filter(|word| !word.is_empty()).collect();
    let numbers: Option<Vec<f64>> = match words[..] {
        [word] => {
            let mut numbers = Vec::new();
            let mut sign = 1.0;
            for character in word.chars() {
                match character.to_digit(10) {
                    Some(digit) => numbers.push(std::mem::replace(&mut sign, 1.0) * f64::from(digit)),
                    None if character == '-' => sign = -1.0,
                    None => return None,
                }
            }
            Some(numbers)
        }
        _ => words.iter().map(|word| word.parse().ok().filter(|number: &f64| number.is_finite())).collect(),
    };
    numbers.filter(|numbers| (3..=4).contains(&numbers.len()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn indices_are_read_with_signs_and_gaps() {
        let read = |text: &str| direction(text).unwrap();
        assert_eq!(read("-1-12"), DVec3::new(-1.0, -1.0, 2.0).normalize());
        assert_eq!(read("4 4 11"), DVec3::new(4.0, 4.0, 11.0).normalize());
        assert_eq!(read("0001"), DVec3::Z);
        assert!(read("11-20").distance(DVec3::new(0.5, 0.75_f64.sqrt(), 0.0)) < 1e-15);
        for (text, part) in [
            ("11", "three indices"),
            ("1x1", "three indices"),
            ("000", "other than 0"),
            ("1120", "is -2"),
            ("10-11", "axis ratio"),
        ] {
            let error = direction(text).unwrap_err();
            assert!(error.contains(part), "{text}: {error}");
        }
    }
}
