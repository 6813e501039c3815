//! Repairs frame times that were printed with too few digits.

/// Returns the whole frame rate N for which 1/N was printed as `printed`, which reads as `stated` seconds; `None` if
/// the value is exact or fits several rates.
///
/// Most programs print 1/120 s as `.0083333`; taken literally, this loses 14 ms in an hour.
pub(super) fn mended_frame_time(printed: &str, stated: f64) -> Option<u32> {
    let rate = (1.0 / stated).round();
    if !(1.0..=100_000.0).contains(&rate) {
        return None;
    }
    let meant = 1.0 / rate;
    // One unit of the last digit: some programs round, others truncate.
    let digit = last_place(printed)?;
    let is_cut = stated != meant && (stated - meant).abs() <= digit;
    // Distances to the next rates up and down: only one rate may fit.
    let is_clear = digit < 0.2 * meant * meant;
    (is_cut && is_clear && !is_exact(meant, digit)).then_some(rate as u32)
}

/// Returns the place value of the last digit of a decimal number; `None` if it has no fraction or an exponent.
fn last_place(printed: &str) -> Option<f64> {
    let (_, fraction) = printed.split_once('.')?;
    let is_plain = fraction.bytes().all(|b| b.is_ascii_digit());
    (is_plain && fraction.len() < 15).then(|| (0..fraction.len()).fold(1.0, |place, _| place / 10.0))
}

/// True if a number of seconds is exact: it needs no more digits than printed.
fn is_exact(seconds: f64, digit: f64) -> bool {
    let units = seconds / digit;
    (units - units.round()).abs() < 1e-9 * units
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_unambiguous_frame_rates_are_corrected() {
        for (printed, rate) in [
            (".0083333", Some(120)),
            ("0.008333", Some(120)),
            ("0.00833333", Some(120)),
            ("0.016667", Some(60)),
            ("0.0166667", Some(60)),
            ("0.033333", Some(30)),
            ("0.0333", Some(30)),
            ("0.0417", Some(24)),
            ("0.016666666666666666", None),
            ("0.04", None),
            ("0.0125", None),
            ("0.0083", None),
            ("0.03", None),
            // 29.97 frames per second, the rate of television.
            ("0.0333667", None),
            ("1", None),
            ("2.5", None),
            ("1e-2", None),
        ] {
            assert_eq!(mended_frame_time(printed, printed.parse().unwrap()), rate, "{printed}");
        }
    }
}
