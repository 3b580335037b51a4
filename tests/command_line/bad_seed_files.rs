use crate::workplace::{FAILED, Workplace};

fn refuses(content: impl AsRef<[u8]>, arguments: &str, message: &str) {
    let workplace = Workplace::new();
    workplace.put("seeds.csv", content);
    workplace.refuses(&format!("--seeds-file seeds.csv {arguments}"), FAILED, message);
}

#[test]
fn no_seeds() {
    let message = "seeds.csv: holds no seeds; give a file with one or more";
    refuses("", "", message);
    refuses("\n\n", "", message);
    refuses("# my seeds\n\n# none yet\n", "", message);
    refuses("x, y, z\n", "", message);
}

#[test]
fn coordinates_that_are_no_finite_numbers() {
    for value in ["nan", "inf", "-Infinity", "1e999"] {
        refuses(
            format!("x,y,z\n0.1,0.2,0.3\n0.5,{value},0.5\n"),
            "",
            &format!("seeds.csv line 3: \"{value}\" is not a finite number; correct or remove the seed"),
        );
    }
    refuses(
        "0.1 0.2 0.3\n0.5 half 0.5\n",
        "",
        "seeds.csv line 2: \"half\" is not a number; write x, y, z as numbers such as 0.5",
    );
}

#[test]
fn columns_that_do_not_fit_the_dimension() {
    refuses(
        "# plane\n0.1,0.2\n",
        "",
        "seeds.csv line 2: 2 columns; write x, y, z on each line, or name the columns in the first",
    );
    refuses(
        "0.1,0.2,0.3,0.4,0.5\n",
        "",
        "seeds.csv line 1: 5 columns; write x, y, z on each line, or name the columns in the first",
    );
    refuses("0.1,0.2,0.3,-0.4\n", "", "seeds.csv line 1: radius is -0.4; write 0 or more");
    refuses(
        "0.1\n",
        "--dim 2",
        "seeds.csv line 1: 1 columns; write x, y on each line, or name the columns in the first",
    );
    refuses(
        "0.1,0.2,0.3\n",
        "--dim 2",
        "seeds.csv line 1: z is 0.3 in a 2D run; set it to 0, run in 3D, or name the columns x, y, radius",
    );
    refuses(
        "y,x,height\n0,0,0\n",
        "",
        "seeds.csv line 1: columns named \"y, x, height\"; name those of the seeds x, y, z",
    );
}

#[test]
fn seeds_outside_the_domain() {
    refuses(
        "0.1,0.2,0.3\n\n2,0.5,0.5\n",
        "",
        "seeds.csv line 3: seed 1 at (2, 0.5, 0.5) lies outside the domain [0, 1] x [0, 1] x [0, 1]; move it inside or enlarge the domain",
    );
    refuses(
        "0.1,-0.2\n",
        "--dim 2 --box 3 4",
        "seeds.csv line 1: seed 0 at (0.1, -0.2, 0) lies outside the domain [0, 3] x [0, 4]; move it inside or enlarge the domain",
    );
}

#[test]
fn seeds_at_the_same_place() {
    refuses(
        "# twice\n0.1,0.2,0.3\n0.5,0.5,0.5\n0.1,0.2,0.3\n",
        "",
        "seeds.csv line 2 and line 4: the same seed (0.1, 0.2, 0.3) twice; remove one of them",
    );
    refuses(
        "0.5,0.5\n0.5,0.5\n",
        "--dim 2",
        "seeds.csv line 1 and line 2: the same seed (0.5, 0.5, 0) twice; remove one of them",
    );
}

/// A quote in the last line once went unseen.
#[test]
fn quote_that_is_left_open() {
    let message =
        |line| format!("seeds.csv line {line}: a quote is not closed on its line; close or remove it");
    refuses("x,y,z,n\n.1,.2,.3,\"a\n.5,.6,.7,b\n", "", &message(2));
    for end in ["", "\n", "\n\n# the end\n"] {
        refuses(format!("x,y,z,n\n.1,.2,.3,a\n.5,.6,.7,\"b{end}"), "", &message(3));
    }
}

/// It was once told as no whole number.
#[test]
fn id_that_is_empty() {
    let message = "seeds.csv line 3: the id is empty; number each seed, or rename the column";
    refuses("id,x,y,z\n7,.1,.2,.3\n,.5,.5,.5\n", "", message);
}

#[test]
fn file_that_is_not_text() {
    refuses(
        b"0.1,0.2,0.3\n\xff\xfe\x00\x01\n",
        "",
        "seeds.csv line 2: not UTF-8 text; save the file as UTF-8",
    );
}

#[test]
fn file_that_cannot_be_read() {
    let workplace = Workplace::new();
    let message = |name| format!("{name}: cannot be read: ... ; give the path of a readable file");
    workplace.refuses("--seeds-file missing.csv", FAILED, &message("missing.csv"));
    std::fs::create_dir(workplace.path("folder")).unwrap();
    workplace.refuses("--seeds-file folder", FAILED, &message("folder"));
}
