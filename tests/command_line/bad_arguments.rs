use crate::workplace::{FAILED, USAGE, Workplace};

/// Checks the message for each value of an option.
fn refuses_values(option: &str, shown: &str, values: &[&str], remedy: &str) {
    let workplace = Workplace::new();
    for value in values {
        let message = format!("invalid value '{value}' for '{shown}': {remedy}");
        workplace.refuses(&format!("{option} {value}"), USAGE, &message);
    }
}

#[test]
fn number_of_seeds() {
    refuses_values(
        "--seeds",
        "--seeds <N>",
        &["0", "-1", "1.5", "many", "1000000000000", "99999999999999999999"],
        "give a whole number from 1 to 4000000000",
    );
}

#[test]
fn number_of_levels() {
    refuses_values(
        "-n",
        "--levels <LEVELS>",
        &["-1", "2.5", "fine", "100", "99999999999"],
        "give a whole number from 0 to 99",
    );
}

#[test]
fn number_of_threads() {
    refuses_values(
        "--threads",
        "--threads <N>",
        &["0", "-2", "all", "1000000"],
        "give a whole number from 1 to 1024",
    );
}

#[test]
fn random_seed() {
    refuses_values(
        "--rng-seed",
        "--rng-seed <S>",
        &["-1", "0.5", "dice", "99999999999999999999"],
        "give a whole number from 0 to 18446744073709551615",
    );
}

#[test]
fn tension_of_walls() {
    refuses_values(
        "--wall-tension",
        "--wall-tension <G>",
        &["-0.1", "nan", "inf", "steep"],
        "a tension is 0 or a positive, finite number",
    );
}

#[test]
fn length_to_regularise_by() {
    refuses_values(
        "--regularize",
        "--regularize <L>",
        &["-1", "0.51", "nan", "inf", "short"],
        "give a length from 0 (off) to 0.5",
    );
}

#[test]
fn relaxation_time() {
    refuses_values(
        "--relax",
        "--relax <T>",
        &["-1", "-0.1", "nan", "inf", "long"],
        "the relaxation time is 0 (off), a positive, finite number, or equilibrium",
    );
}

#[test]
fn free_grains_without_a_time() {
    let workplace = Workplace::new();
    let message =
        "--free lets grains grow for a time, and has no equilibrium; give a time, such as --relax 0.3";
    workplace.refuses("--seeds 10 --free --relax equilibrium", USAGE, message);
    workplace.refuses("--seeds 10 --dim 2 --free --relax equilibrium", USAGE, message);
}

#[test]
fn dimension() {
    refuses_values("--dim", "--dim <2|3>", &["1", "4", "flat"], "grains have 2 or 3 dimensions");
}

#[test]
fn sides_of_the_box() {
    let workplace = Workplace::new();
    for value in ["0", "-1", "nan", "inf", "wide", "1e-31", "1e300"] {
        for sides in [format!("{value} 1 1"), format!("1 {value} 1"), format!("1 1 {value}")] {
            let message = format!(
                "invalid value '{value}' for '--box <X> <Y> [Z]...': a side of the box is a positive number between 1e-30 and 1e30"
            );
            workplace.refuses(&format!("--box {sides}"), USAGE, &message);
        }
    }
}

#[test]
fn box_that_does_not_fit_the_dimension() {
    let workplace = Workplace::new();
    for (arguments, message) in [
        ("--box 1 1", "--box takes three numbers, X Y Z, without --dim 2; 2 given"),
        ("--box 1", "2 values required by '--box <X> <Y> [Z]...'; only 1 was provided"),
        ("--box 1 1 1 1", "--box takes three numbers, X Y Z, without --dim 2; 4 given"),
        ("--dim 2 --box 1 1 1", "--box takes two numbers, X Y, with --dim 2; 3 given"),
    ] {
        workplace.refuses(arguments, USAGE, message);
    }
}

#[test]
fn option_that_does_not_exist() {
    let workplace = Workplace::new();
    workplace.refuses("--seed 3", USAGE, "unexpected argument '--seed' found");
    workplace.refuses("-x", USAGE, "unexpected argument '-x' found");
    workplace.refuses("200", USAGE, "unrecognized subcommand '200'");
    let said = workplace.command("--sedes 3").assert().get_output().stderr.clone();
    assert!(String::from_utf8(said).unwrap().contains("a similar argument exists: '--seeds'"));
}

#[test]
fn value_that_does_not_exist() {
    let workplace = Workplace::new();
    workplace.refuses("--junctions round", USAGE, "invalid value 'round' for '--junctions <RULE>'");
    let said = workplace.command("--junctions round").assert().get_output().stderr.clone();
    assert!(String::from_utf8(said).unwrap().contains("[possible values: crease, corner]"));
}

#[test]
fn value_that_is_missing() {
    let workplace = Workplace::new();
    for option in ["--seeds <N>", "--relax <T>", "--output <PATH>", "--seeds-file <FILE>"] {
        let name = option.split(' ').next().unwrap();
        let message = format!("a value is required for '{option}' but none was supplied");
        workplace.refuses(name, USAGE, &message);
    }
}

#[test]
fn seeds_from_two_sources() {
    let workplace = Workplace::new();
    workplace.put("seeds.csv", "0.5, 0.5, 0.5\n");
    let message = "the argument '--seeds-file <FILE>' cannot be used with '--seeds <N>'";
    workplace.refuses("--seeds-file seeds.csv --seeds 3", USAGE, message);
    let message = "the argument '--rng-seed <S>' cannot be used with '--seeds-file <FILE>'";
    workplace.refuses("--rng-seed 3 --seeds-file seeds.csv", USAGE, message);
}

/// The message names the bytes needed and available and what would fit; only the available ones differ.
#[test]
fn more_than_memory_holds() {
    let workplace = Workplace::new();
    for (arguments, start, end) in [
        ("-n 20", "20 levels would take", "levels would fit"),
        ("-n 99", "99 levels would take over 1000 EB of memory and", "levels would fit"),
        ("--dim 2 -n 40", "40 levels would take", "levels would fit"),
        ("--seeds 4000000000", "3 levels would take", "not even 0 levels would fit; use fewer seeds"),
        ("--seeds 4000000000 --dim 2", "3 levels would take", "use fewer seeds"),
        (
            "--seeds 4000000000 --no-mesh",
            "4000000000 cells would take 6.4 TB of memory and",
            "use fewer seeds",
        ),
    ] {
        workplace.refuses(arguments, FAILED, &format!("{start} ... {end}"));
    }
}

/// Formats that hold all voxels at once, which not all do; a network that is there already has no estimate.
#[test]
fn more_voxels_than_memory_holds() {
    let workplace = Workplace::new();
    workplace.run("--seeds 2 -n 0 --relax 0 -o two.vtp");
    let message = |needed: &str| {
        format!(
            "with so many voxels, the run would take {needed} of memory and ... are available; give fewer with --voxels"
        )
    };
    for (arguments, needed) in [
        ("-o a.inp", "2.0 PB"),
        ("--volume-mesh -o a.vtu", "9.5 PB"),
        ("-o a.dream3d", "5.0 PB"),
        ("smooth two.vtp -n 1 -o a.inp", "2.0 PB"),
        ("remesh two.vtp --elements-per-grain 1 -o a.inp", "2.0 PB"),
    ] {
        let arguments = format!("{arguments} --voxels 50000 50000 50000");
        workplace.refuses(&arguments, FAILED, &message(needed));
    }
}

/// A seed file's size is known only when its cells are.
#[test]
fn more_levels_than_memory_holds_for_seeds_from_a_file() {
    let workplace = Workplace::new();
    workplace.put("seeds.csv", "0.2, 0.5, 0.5\n0.7, 0.5, 0.5\n");
    let message = "20 levels would take ... levels would fit";
    workplace.refuses("--seeds-file seeds.csv -n 20", FAILED, message);
}
