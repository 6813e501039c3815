//! Weights of the clips to blend for a speed, or for a speed and a direction.

use sinew_math::{Vec2, clamp, max};

/// Computes weights of clips on a line: the two neighbours of `at` share the weight in proportion; beyond an end, the
/// end has all of it. `places` are in any unit, not decreasing, as many as `weights`; the weights sum to 1. Of clips at
/// one place the first counts. NaN counts as the first place.
///
/// # Panics
/// If there are no places, they decrease or are not finite, or `weights` has another length.
pub fn weights_on_line(places: &[f32], at: f32, weights: &mut [f32]) {
    assert_eq!(places.len(), weights.len(), "a weight for each place");
    assert!(
        !places.is_empty() && places.iter().all(|place| place.is_finite()),
        "places are finite, and there is one"
    );
    assert!(places.windows(2).all(|pair| pair[0] <= pair[1]), "places are in order");
    weights.fill(0.0);
    let at = clamp(at, places[0], places[places.len() - 1]);
    let right = places.partition_point(|&place| place < at);
    if right == 0 || places[right] == at {
        weights[right] = 1.0;
        return;
    }
    let share = (at - places[right - 1]) / (places[right] - places[right - 1]);
    weights[right - 1] = 1.0 - share;
    weights[right] = share;
}

/// Computes weights of clips in a plane by gradient bands (Johansen, "Automated semi-procedural animation for character
/// locomotion", 2009, section 6.3). Each clip has full weight at its own place and none at another's. Weights are
/// continuous, never negative, and sum to 1; no triangulation is needed. `places` are in any unit, as many as
/// `weights`; of clips at one place the first counts. NaN counts as 0.
///
/// # Panics
/// If there are no places, one is not finite, or `weights` has another length.
pub fn weights_on_plane(places: &[Vec2], at: Vec2, weights: &mut [f32]) {
    assert_eq!(places.len(), weights.len(), "a weight for each place");
    assert!(
        !places.is_empty() && places.iter().all(|place| place.is_finite()),
        "places are finite, and there is one"
    );
    let number = |x: f32| if x.is_nan() { 0.0 } else { clamp(x, -1e15, 1e15) };
    let at = Vec2::new(number(at.x), number(at.y));
    let mut total = 0.0;
    for i in 0..places.len() {
        weights[i] = if places[..i].contains(&places[i]) { 0.0 } else { influence(places, i, at) };
        total += weights[i];
    }
    // At a great distance, rounding can leave no weight; then the nearest clip gets all of it.
    if total < 1e-6 {
        let distance = |i: usize| (places[i] - at).length_squared();
        let nearest =
            (1..places.len()).fold(0, |best, i| if distance(i) < distance(best) { i } else { best });
        weights.fill(0.0);
        weights[nearest] = 1.0;
        return;
    }
    for weight in weights {
        *weight /= total;
    }
}

/// Returns the smallest remaining share of `at` on the lines from place `i` to all other places.
fn influence(places: &[Vec2], i: usize, at: Vec2) -> f32 {
    let own = places[i];
    let mut least = 1.0;
    for &other in places {
        let way = other - own;
        let square = way.dot(way);
        if square > 0.0 {
            let share = 1.0 - (at - own).dot(way) / square;
            least = if share < least { share } else { least };
        }
    }
    max(least, 0.0)
}
