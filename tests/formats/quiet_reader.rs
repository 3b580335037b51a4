//! What tests of corrupt files share.

use std::sync::Once;

use grainsmooth::mesh::file::READER_THREAD;

/// Panics of the thread in which `vtkio` reads become errors; their words would only fill the tests' output.
pub fn keep_reader_quiet() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let hook = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |info| {
            if std::thread::current().name() != Some(READER_THREAD) {
                hook(info);
            }
        }));
    });
}
