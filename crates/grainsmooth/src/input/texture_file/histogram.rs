//! Histograms of disorientation angles: on each line the upper end of a bin in degrees, and its weight.

use super::{Fault, number, of_text};
use crate::files::text_table;

/// A line, and the upper end in degrees and the weight of the bin there.
type Bin = (usize, (f64, f64));

/// Reads the bins. Lines that begin with `#` are comments, and the first may name the columns.
pub(super) fn read(content: &[u8]) -> Result<Vec<Bin>, Fault> {
    let mut bins = Vec::new();
    let mut may_be_names = true;
    for row in text_table::rows(content).map_err(of_text)? {
        let row = row.map_err(of_text)?;
        let (line, columns) = (row.line, row.columns());
        let is_names = may_be_names && text_table::are_names(&columns);
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
