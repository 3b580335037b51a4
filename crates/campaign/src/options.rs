//! A command line of `grainsmooth`, while it is put together.

/// Options that are given once for each of their values.
const REPEATED: [&str; 5] = ["inside", "mobility", "output", "phase", "tension"];

/// Options by their long names, each with its values; a switch has none.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Options(Vec<(&'static str, Vec<String>)>);

impl Options {
    /// Gives an option these values, instead of any that it has.
    pub fn set<T: ToString>(&mut self, name: &'static str, values: impl IntoIterator<Item = T>) {
        self.unset(name);
        self.0.push((name, values.into_iter().map(|value| value.to_string()).collect()));
    }

    /// Turns a switch on.
    pub fn switch(&mut self, name: &'static str) {
        self.set(name, [""; 0]);
    }

    /// Takes an option away.
    pub fn unset(&mut self, name: &str) {
        self.0.retain(|(known, _)| *known != name);
    }

    /// Whether the option is given.
    pub fn has(&self, name: &str) -> bool {
        self.0.iter().any(|(known, _)| *known == name)
    }

    /// The first value of an option.
    pub fn value(&self, name: &str) -> Option<&str> {
        let (_, values) = self.0.iter().find(|(known, _)| *known == name)?;
        values.first().map(String::as_str)
    }

    /// All values of an option; none where it is not given.
    pub fn values(&self, name: &str) -> &[String] {
        let found = self.0.iter().find(|(known, _)| *known == name);
        found.map_or(&[], |(_, values)| values)
    }

    /// The words of the command line.
    pub fn words(&self) -> Vec<String> {
        let words = |(name, values): &(&str, Vec<String>)| -> Vec<String> {
            let option = format!("--{name}");
            if REPEATED.contains(name) {
                return values.iter().flat_map(|value| [option.clone(), value.clone()]).collect();
            }
            std::iter::once(option).chain(values.iter().cloned()).collect()
        };
        self.0.iter().flat_map(words).collect()
    }

    /// The same as a TOML file for `--config`.
    pub fn toml(&self) -> String {
        let line = |(name, values): &(&str, Vec<String>)| match &values[..] {
            [] => format!("{name} = true\n"),
            [value] => format!("{name} = {value:?}\n"),
            values => format!("{name} = {values:?}\n"),
        };
        self.0.iter().map(line).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_become_words_or_a_toml_file() {
        let mut options = Options::default();
        options.set("box", [1.0, 2.0]);
        options.set("seeds", [7]);
        options.switch("free");
        options.set("box", [1e-9, 1.0]);
        options.set("output", ["a.vtp", "b.stl"]);
        let words = "--seeds 7 --free --box 0.000000001 1 --output a.vtp --output b.stl";
        assert_eq!(options.words().join(" "), words);
        let toml =
            "seeds = \"7\"\nfree = true\nbox = [\"0.000000001\", \"1\"]\noutput = [\"a.vtp\", \"b.stl\"]\n";
        assert_eq!(options.toml(), toml);
        assert_eq!(options.value("seeds"), Some("7"));
        assert!(options.has("free") && options.value("free").is_none());
    }
}
