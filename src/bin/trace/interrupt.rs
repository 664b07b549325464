//! Interrupts from the keyboard.

use fieldtrace::cancel::Cancel;

/// A token that the first interrupt stops; the second ends the program at once.
///
/// # Errors
/// When interrupts cannot be received.
pub(crate) fn token() -> Result<Cancel, ctrlc::Error> {
    let cancel = Cancel::default();
    let token = cancel.clone();
    ctrlc::set_handler(move || {
        if token.check().is_err() {
            std::process::exit(130);
        }
        token.cancel();
    })?;
    Ok(cancel)
}
