//! Quick looks at numbers, which spare most of them a thorough one.

/// Whether `word` is a decimal fraction of so few digits that it is within the range in which a
/// scene can be traced.
pub(super) fn is_plain_fraction(word: &str) -> bool {
    // Fewer than 18 digits stay below 2^60.
    let digits = word.strip_prefix('-').unwrap_or(word).as_bytes();
    let (mut any, mut point) = (false, false);
    for &byte in digits {
        match byte {
            b'0'..=b'9' => any = true,
            b'.' if !point => point = true,
            _ => return false,
        }
    }
    any && digits.len() < 18
}

/// A positive number of at most nine digits.
pub(super) fn plain_index(word: &str) -> Option<usize> {
    let digits = word.as_bytes();
    if digits.is_empty() || digits.len() > 9 {
        return None;
    }
    digits.iter().try_fold(0, |number, byte| {
        let digit = byte.wrapping_sub(b'0');
        (digit < 10).then_some(10 * number + usize::from(digit))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_plain_ones_pass() {
        for word in ["0", "-1", "1.5", ".5", "5.", "-0.00000000000001"] {
            assert!(is_plain_fraction(word) && word.parse::<f32>().is_ok(), "{word}");
        }
        for word in ["", "-", ".", "-.", "1e3", "nan", "1.2.3", "--1", "1,5", "123456789012345678"] {
            assert!(!is_plain_fraction(word), "{word}");
        }
        assert_eq!((plain_index("0"), plain_index("120")), (Some(0), Some(120)));
        for word in ["", "-1", "+1", "1/2", "1234567890"] {
            assert_eq!(plain_index(word), None, "{word}");
        }
    }
}
