//! Fast parsers for plain numbers, the most common content of a file.

/// The powers of ten that `f32` represents exactly.
const POWERS_OF_TEN: [f32; 11] = [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10];

/// A decimal fraction of few digits, with the bits that `str::parse` returns. `None` for any other word.
///
/// `f32` represents the digits up to 2^24 and the power of ten exactly. Their quotient is rounded once, so it
/// is correctly rounded (Clinger 1990).
pub(super) fn fraction(word: &str) -> Option<f32> {
    let (negative, digits) = match word.strip_prefix('-') {
        Some(digits) => (true, digits.as_bytes()),
        None => (false, word.as_bytes()),
    };
    let (mut number, mut decimals, mut point, mut any) = (0_u32, 0, false, false);
    if digits.len() > 9 {
        return None;
    }
    for &byte in digits {
        let digit = byte.wrapping_sub(b'0');
        if digit < 10 {
            number = 10 * number + u32::from(digit);
            decimals += usize::from(point);
            any = true;
        } else if byte == b'.' && !point {
            point = true;
        } else {
            return None;
        }
    }
    let exact = any && number <= 1 << 24;
    let value = number as f32 / POWERS_OF_TEN[decimals];
    exact.then_some(if negative { -value } else { value })
}

/// A number of at most nine digits without a sign. `None` for any other word.
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
    fn fractions_are_those_of_the_standard_library() {
        for word in ["0", "-0", "-1", "1.5", ".5", "5.", "0.1", "-0.000001", "16777216", "0.3333333"] {
            let quick = fraction(word).map(f32::to_bits);
            assert_eq!(quick, word.parse::<f32>().ok().map(f32::to_bits), "{word}");
        }
        for number in (0..1 << 24).step_by(997) {
            let word = format!("{}.{:06}", number / 1_000_000, number % 1_000_000);
            assert_eq!(fraction(&word), word.parse().ok(), "{word}");
        }
        for word in ["", "-", ".", "-.", "1e3", "nan", "1.2.3", "--1", "+1", "1,5", "1234567890", "16777217"]
        {
            assert_eq!(fraction(word), None, "{word}");
        }
    }

    #[test]
    fn only_plain_indices_pass() {
        assert_eq!((plain_index("0"), plain_index("120")), (Some(0), Some(120)));
        for word in ["", "-1", "+1", "1/2", "1234567890"] {
            assert_eq!(plain_index(word), None, "{word}");
        }
    }
}
