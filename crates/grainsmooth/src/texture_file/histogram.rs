//! Histograms of disorientation angles: on each line the upper end of a bin in degrees, and its weight.

use super::{Fault, columns, number};

/// A line, and the upper end in degrees and the weight of the bin there.
type Bin = (usize, (f64, f64));

/// Reads the bins. Lines that begin with `#` are comments, and the first may name the columns.
pub(super) fn read(text: &str) -> Result<Vec<Bin>, Fault> {
    let mut bins = Vec::new();
    let mut may_be_names = true;
    for (line, text) in (1..).zip(text.lines().map(|line| line.trim_start_matches('\u{feff}').trim())) {
        if text.is_empty() || text.starts_with('#') {
            continue;
        }
        let columns = columns(text);
        let is_names = may_be_names && columns.iter().all(|column| column.parse::<f64>().is_err());
        may_be_names = false;
        match columns[..] {
            _ if is_names => {}
            [end, weight] => bins.push((line, (number(line, end)?, number(line, weight)?))),
            _ => {
                let found = columns.len();
                return Err((
                    line,
                    format!("{found} columns; write the upper end of a bin in degrees and its weight"),
                ));
            }
        }
    }
    Ok(bins)
}
