use std::fmt::{self, Display, Write};

/// `text` with control characters escaped, so that names in a file cannot break the line of a message or control the
/// terminal.
pub(crate) fn escaped<T: Display>(text: T) -> impl Display {
    Escaped(text)
}

struct Escaped<T>(T);

impl<T: Display> Display for Escaped<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(Escaping(f), "{}", self.0)
    }
}

struct Escaping<'a, 'b>(&'a mut fmt::Formatter<'b>);

impl Write for Escaping<'_, '_> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        text.chars().try_for_each(|c| self.write_char(c))
    }

    fn write_char(&mut self, c: char) -> fmt::Result {
        if c.is_control() { write!(self.0, "{}", c.escape_default()) } else { self.0.write_char(c) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_control_characters_are_escaped() {
        assert_eq!(escaped("a \\ `b` é ü.obj").to_string(), "a \\ `b` é ü.obj");
        assert_eq!(escaped("a\nb\r\t\u{1b}[2J\0\u{85}").to_string(), r"a\nb\r\t\u{1b}[2J\u{0}\u{85}");
    }
}
