//! Relaxation that cannot be done.

use super::workplace::{FAILED, Workplace};

/// The message names the grain, the time and a time that works; once it named the time asked for alone.
#[test]
fn a_free_grain_that_vanishes_is_named_with_a_time_that_works() {
    let workplace = Workplace::new();
    let grains = "--dim 2 --seeds 30 -n 0 --free";
    let too_long = format!("{grains} --relax 1");
    workplace.refuses(&too_long, FAILED, "grain ... works");
    let said = workplace.command(&too_long).assert().get_output().stderr.clone();
    let said = String::from_utf8(said).unwrap();
    assert!(said.contains(" shrinks to nothing by the relaxation time 0."), "{said}");
    assert!(said.contains(", and none can vanish; relax for a shorter time, or keep volumes; "), "{said}");
    let works = said.trim_end().rsplit_once("; --relax ").unwrap().1.strip_suffix(" works").unwrap();
    assert!(works.parse::<f64>().unwrap() > 0.1, "{said}");
    workplace.run(&format!("{grains} --relax {works} -o a.vtp"));
}
