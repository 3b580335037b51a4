use std::fmt;

/// A number of things with their noun: `1 edge`, `2 edges`, `0 small boundaries`.
#[derive(Debug, Clone, Copy)]
pub struct Counted(pub usize, pub &'static str);

impl fmt::Display for Counted {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(count, noun) = self;
        match (count, noun.strip_suffix('y')) {
            (1, _) => write!(formatter, "1 {noun}"),
            (_, Some(stem)) => write!(formatter, "{count} {stem}ies"),
            (_, None) => write!(formatter, "{count} {noun}s"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_thing_is_no_plural() {
        let spelled = |count, noun| Counted(count, noun).to_string();
        assert_eq!(spelled(1, "edge"), "1 edge");
        assert_eq!(spelled(0, "edge"), "0 edges");
        assert_eq!(spelled(1, "small boundary"), "1 small boundary");
        assert_eq!(spelled(12, "small boundary"), "12 small boundaries");
    }
}
