//! Ctrl-C: the program ends at once, at any place, but never within a write.

use crate::error::Error;
use std::sync::{PoisonError, RwLock};
use std::time::Duration;

/// Held shared by every write.
static WRITES: RwLock<()> = RwLock::new(());
/// How long a write is waited for, one to a pipe that nobody reads among them.
const PATIENCE: Duration = Duration::from_millis(300);

/// Ends the program with the status of [`Error::Interrupted`] when the user presses Ctrl-C, after `tell` has said so.
pub fn watch(tell: impl Fn(&str) + Send + 'static) {
    // Without a handler Ctrl-C ends the program as well, with the status of the signal.
    let _ = ctrlc::set_handler(move || {
        let status = Error::Interrupted.exit_code().into();
        let _ = std::thread::Builder::new().spawn(move || {
            std::thread::sleep(PATIENCE);
            std::process::exit(status);
        });
        let _last = WRITES.write().unwrap_or_else(PoisonError::into_inner);
        tell(&Error::Interrupted.to_string());
        std::process::exit(status);
    });
}

/// Does what Ctrl-C may come before or after, not between; it must not call itself.
pub fn whole<T>(write: impl FnOnce() -> T) -> T {
    let _shared = WRITES.read().unwrap_or_else(PoisonError::into_inner);
    write()
}
