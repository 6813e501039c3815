//! Removes deeds from a failing life as long as it fails in the same way.

use crate::life::Life;
use crate::run::{Failure, run};
use std::time::{Duration, Instant};

/// Time after which shrinking stops.
const TIME: Duration = Duration::from_secs(60);

/// Returns the smallest life found that fails like the given one, and its failure.
pub fn shrunk(life: &Life, failure: &Failure) -> (Life, Failure) {
    let start = Instant::now();
    let mut least = (life.clone(), failure.clone());
    cut_end(&mut least);
    let mut piece = usize::max(least.0.acts.len() / 2, 1);
    loop {
        let mut at = 0;
        let mut shorter = false;
        while at < least.0.acts.len() {
            if start.elapsed() > TIME {
                return least;
            }
            let mut less = least.0.clone();
            let end = usize::min(at + piece, less.acts.len());
            less.acts.drain(at..end);
            if fails_alike(less, &mut least) {
                shorter = true;
            } else {
                at += piece;
            }
        }
        if piece == 1 && !shorter {
            break;
        }
        piece = usize::max(piece / 2, 1);
    }
    earlier(&mut least, start);
    least
}

fn cut_end(least: &mut (Life, Failure)) {
    let last = least.1.step;
    least.0.acts.retain(|act| act.step <= last);
}

/// Replaces `least` by `less` if that fails in the same way. Returns whether it did.
fn fails_alike(less: Life, least: &mut (Life, Failure)) -> bool {
    let Err(found) = run(&less, None, false).result else { return false };
    if !found.fault.is_like(&least.1.fault) {
        return false;
    }
    *least = (less, found);
    cut_end(least);
    true
}

/// Moves deeds to the earliest possible step.
fn earlier(least: &mut (Life, Failure), start: Instant) {
    for by in [64, 16, 4, 1] {
        let mut from = 0;
        while from < least.0.acts.len() && start.elapsed() < TIME {
            let mut less = least.0.clone();
            let before = if from == 0 { 0 } else { less.acts[from - 1].step };
            if less.acts[from].step >= before + by {
                less.acts[from..].iter_mut().for_each(|act| act.step -= by);
                if fails_alike(less, least) {
                    continue;
                }
            }
            from += 1;
        }
    }
}
