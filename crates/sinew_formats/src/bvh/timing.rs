//! Frame times that were printed with too few digits.

/// The whole frame rate N whose 1/N is meant by a frame time printed as `printed`, which reads as `stated` seconds;
/// `None` where it says what it means, or where it could mean several rates.
///
/// 1/120 s is printed as `.0083333` by most programs; taken at its word it would lose 14 ms in an hour.
pub(super) fn mended_frame_time(printed: &str, stated: f64) -> Option<u32> {
    let rate = (1.0 / stated).round();
    if !(1.0..=100_000.0).contains(&rate) {
        return None;
    }
    let meant = 1.0 / rate;
    // One unit of the last place: some programs round, others cut.
    let digit = last_place(printed)?;
    let is_cut = stated != meant && (stated - meant).abs() <= digit;
    // The next rates up and down lie this much away: only one may fit.
    let is_clear = digit < 0.2 * meant * meant;
    (is_cut && is_clear && !is_exact(meant, digit)).then_some(rate as u32)
}

/// Worth of the last digit of a decimal number; `None` if it has no fraction or is written with an exponent.
fn last_place(printed: &str) -> Option<f64> {
    let (_, fraction) = printed.split_once('.')?;
    let is_plain = fraction.bytes().all(|b| b.is_ascii_digit());
    (is_plain && fraction.len() < 15).then(|| (0..fraction.len()).fold(1.0, |place, _| place / 10.0))
}

/// True if a number of seconds needs no more digits than those printed: then others were meant.
fn is_exact(seconds: f64, digit: f64) -> bool {
    let units = seconds / digit;
    (units - units.round()).abs() < 1e-9 * units
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_can_mean_one_rate_is_mended() {
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
            // 29.97 frames a second, of television.
            ("0.0333667", None),
            ("1", None),
            ("2.5", None),
            ("1e-2", None),
        ] {
            assert_eq!(mended_frame_time(printed, printed.parse().unwrap()), rate, "{printed}");
        }
    }
}
