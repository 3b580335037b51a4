//! Relaxation that cannot be done.

use super::workplace::{FAILED, Workplace};

/// The message names the grain, the time and a time that works; once it named the time asked for alone.
#[test]
fn a_free_grain_that_vanishes_is_named_with_a_time_that_works() {
    let workplace = Workplace::new();
    for grains in [
        "--dim 2 --seeds 30 --seeding random -n 0 --free --regularize 0.05",
        // In space grains vanish, but for those of several cells.
        "--seeds 5 --phase a:0.9 --phase b:0.1,place=boundaries -n 0 --free",
        // What was held of a grain that is folded once stayed for any time.
        "--seeds 15 --rng-seed 4 -n 0 --free --regularize 0.05",
    ] {
        let too_long = format!("{grains} --relax 1");
        workplace.refuses(&too_long, FAILED, "grain ... works");
        let said = workplace.command(&too_long).assert().get_output().stderr.clone();
        let said = String::from_utf8(said).unwrap();
        assert!(said.contains(" shrinks to nothing by the relaxation time 0."), "{said}");
        assert!(
            said.contains(", and none can vanish; relax for a shorter time, or keep volumes; "),
            "{said}"
        );
        let works = said.trim_end().rsplit_once("; --relax ").unwrap().1.strip_suffix(" works").unwrap();
        assert!(works.parse::<f64>().unwrap() > 0.05, "{said}");
        workplace.run(&format!("{grains} --relax {works} -o a.vtp"));
    }
}

/// Where no time works, the message once named none, and the time of the first grain as 0.000.
#[test]
fn tiny_free_grains_are_named_with_the_way_to_take_them_out() {
    let workplace = Workplace::new();
    let tiny = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [0.5, 0.5]];
    let tiny = tiny.map(|[x, y]| format!("{} {}\n", 0.5 + 1e-4 * x, 0.5 + 1e-4 * y));
    let large = ["0.1 0.1\n", "0.9 0.2\n", "0.2 0.9\n", "0.8 0.8\n", "0.5 0.1\n"].map(str::to_owned);
    workplace.put("seeds.txt", (large.concat() + &tiny.concat()).into_bytes());
    let arguments = "--dim 2 --seeds-file seeds.txt -n 1 --free --regularize 0.05";
    let remedy =
        "no shorter time that was tried works: merge the smallest cells, such as with --min-diameter 0.5";
    workplace.refuses(
        arguments,
        FAILED,
        &format!("grain 9 shrinks to nothing by the relaxation time ... {remedy}"),
    );
    workplace.run(&format!("{arguments} --min-diameter 0.5 -o a.vtp"));
}

/// Boundaries fold where short lines are kept. The message once advised a shorter time, which helps here but not in general, and to merge
/// grains.
#[test]
fn short_lines_that_are_kept_are_named_where_all_goes_well_without() {
    let workplace = Workplace::new();
    let arguments = "--seeding random --seeds 200 --rng-seed 1 --faces plain -n 1 --relax 10";
    let remedy = "without --regularize 0, which keeps short triple lines, it works";
    let message = format!("6 edges inside boundaries are folded ... {remedy}");
    workplace.refuses(&format!("{arguments} --regularize 0"), FAILED, &message);
    workplace.run(&format!("{arguments} -o a.vtp"));
}
