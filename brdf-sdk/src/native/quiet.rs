//! Panics that become a sentence: while a library loads, the panic's words and place are kept and not printed.
//!
//! Catching them is the caller's. Other threads print as before; the hook that was there before is asked for them.

use std::cell::RefCell;
use std::panic::{PanicHookInfo, set_hook, take_hook};
use std::sync::Once;

thread_local! {
    /// Set while this thread is quiet; what was said is the first panic's.
    static SAID: RefCell<Option<String>> = const { RefCell::new(None) };
    static QUIET: RefCell<bool> = const { RefCell::new(false) };
}

/// Runs `work` without printing this thread's panics. Also what the first one said, `at FILE:LINE: words`.
pub(super) fn quietly<T>(work: impl FnOnce() -> T) -> (T, Option<String>) {
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        let before = take_hook();
        set_hook(Box::new(move |panic| match QUIET.with_borrow(|quiet| *quiet) {
            true => SAID.with_borrow_mut(|said| _ = said.get_or_insert_with(|| words(panic))),
            false => before(panic),
        }));
    });
    let before = QUIET.replace(true);
    SAID.set(None);
    let done = work();
    QUIET.set(before);
    (done, SAID.take())
}

fn words(panic: &PanicHookInfo<'_>) -> String {
    let said = panic.payload_as_str().unwrap_or("no reason given");
    match panic.location() {
        Some(place) => format!("at {}:{}: {said}", place.file(), place.line()),
        None => said.to_owned(),
    }
}
