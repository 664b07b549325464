//! Interrupts from the keyboard, and the signal that asks a program to end.

use crate::cancel::Cancel;

/// A token that the first interrupt stops; the second ends the program at once. Where there are signals, SIGTERM, as
/// schedulers send it, is an interrupt too.
///
/// # Errors
/// When interrupts cannot be received.
pub(crate) fn token() -> Result<Cancel, ctrlc::Error> {
    let cancel = Cancel::default();
    let token = cancel.clone();
    ctrlc::set_handler(move || interrupt(&token))?;
    #[cfg(unix)]
    on_termination(cancel.clone()).map_err(ctrlc::Error::System)?;
    Ok(cancel)
}

fn interrupt(token: &Cancel) {
    if token.check().is_err() {
        std::process::exit(130);
    }
    token.cancel();
}

/// Not by the feature of `ctrlc`: that takes SIGHUP along, which has to stay ignored under `nohup`.
#[cfg(unix)]
fn on_termination(token: Cancel) -> std::io::Result<()> {
    let mut signals = signal_hook::iterator::Signals::new([signal_hook::consts::SIGTERM])?;
    std::thread::Builder::new().spawn(move || signals.forever().for_each(|_| interrupt(&token)))?;
    Ok(())
}
