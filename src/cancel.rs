//! A way to stop work from outside.

use crate::error::{Error, Result};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use web_time::Instant;

/// Stops work that polls it: when told to, or when a time has run out. Clones stop together.
///
/// ```
/// use fieldtrace::cancel::Cancel;
///
/// let cancel = Cancel::default();
/// let clone = cancel.clone();
/// assert!(clone.check().is_ok());
/// cancel.cancel();
/// assert!(clone.check().is_err());
/// ```
#[derive(Clone, Debug, Default)]
pub struct Cancel {
    told: Arc<AtomicBool>,
    limit: Option<Limit>,
    /// Another one that stops this one.
    other: Option<Arc<Cancel>>,
}

/// When to stop by oneself.
#[derive(Clone, Copy, Debug)]
struct Limit {
    start: Instant,
    length: Duration,
}

impl Cancel {
    /// Tells the work to stop.
    pub fn cancel(&self) {
        self.told.store(true, Ordering::Relaxed);
    }

    /// One that stops with this one, and also when a time from now has run out.
    #[must_use]
    pub fn within(&self, length: Duration) -> Self {
        Self { limit: Some(Limit { start: Instant::now(), length }), ..self.clone() }
    }

    /// One that stops with this one, and also with another.
    #[must_use]
    pub fn or(&self, other: &Self) -> Self {
        let rest = self.other.as_ref().map_or_else(|| other.clone(), |rest| rest.or(other));
        Self { other: Some(Arc::new(rest)), ..self.clone() }
    }

    /// Polled between and inside the stages; cheap enough for any loop whose turns take microseconds.
    ///
    /// # Errors
    /// [`Error::Cancelled`] when the work was told to stop, [`Error::TimedOut`] when its time has run out.
    pub fn check(&self) -> Result<()> {
        if self.told.load(Ordering::Relaxed) {
            return Err(Error::Cancelled);
        }
        match self.limit {
            Some(Limit { start, length }) if start.elapsed() >= length => Err(Error::TimedOut { limit: length }),
            _ => self.other.as_ref().map_or(Ok(()), |other| other.check()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_limit_is_its_own_and_the_word_is_shared() {
        let cancel = Cancel::default();
        let over = cancel.within(Duration::ZERO);
        assert!(matches!(over.check(), Err(Error::TimedOut { limit: Duration::ZERO })));
        assert!(cancel.check().is_ok());
        let ample = cancel.within(Duration::MAX);
        assert!(ample.check().is_ok());
        ample.cancel();
        for told in [cancel, over, ample] {
            assert!(matches!(told.check(), Err(Error::Cancelled)));
        }
    }

    #[test]
    fn any_of_several_stops_what_was_joined() {
        for stopped in 0..3 {
            let parts = [0; 3].map(|_| Cancel::default());
            let joined = parts[0].or(&parts[1]).or(&parts[2]);
            assert!(joined.check().is_ok());
            parts[stopped].cancel();
            assert!(joined.check().is_err());
            assert_eq!(parts.iter().filter(|part| part.check().is_err()).count(), 1);
        }
        let over = Cancel::default().within(Duration::ZERO);
        assert!(matches!(Cancel::default().or(&over).check(), Err(Error::TimedOut { .. })));
    }
}
