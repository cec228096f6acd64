//! Functions with the same signature in both versions of the standard, and unsupported functions.

/// Defines functions with the same arguments in both versions.
macro_rules! both {
    (
        free: $free:ident, end_initialization: $end:ident, terminate: $terminate:ident, reset: $reset:ident,
        save: $save:ident, restore: $restore:ident, free_state: $free_state:ident,
        size: $size:ident, write: $write:ident, read: $read:ident,
    ) => {
        #[unsafe(no_mangle)]
        extern "C" fn $free(instance: *mut c_void) {
            free(instance);
        }

        #[unsafe(no_mangle)]
        extern "C" fn $end(instance: *mut c_void) -> c_int {
            call(instance, |slave| slave.unit.start(slave.start_s))
        }

        #[unsafe(no_mangle)]
        extern "C" fn $terminate(instance: *mut c_void) -> c_int {
            call(instance, |_| Ok(()))
        }

        #[unsafe(no_mangle)]
        extern "C" fn $reset(instance: *mut c_void) -> c_int {
            call(instance, |slave| {
                slave.unit.reset();
                Ok(())
            })
        }

        #[unsafe(no_mangle)]
        extern "C" fn $save(instance: *mut c_void, state: *mut *mut c_void) -> c_int {
            call(instance, |slave| slave.save(state))
        }

        #[unsafe(no_mangle)]
        extern "C" fn $restore(instance: *mut c_void, state: *mut c_void) -> c_int {
            call(instance, |slave| {
                let saved = slave.saved(state)?;
                slave.unit.restore(saved)
            })
        }

        #[unsafe(no_mangle)]
        extern "C" fn $free_state(instance: *mut c_void, state: *mut *mut c_void) -> c_int {
            call(instance, |slave| slave.free_saved(state))
        }

        #[unsafe(no_mangle)]
        extern "C" fn $size(instance: *mut c_void, state: *mut c_void, size: *mut usize) -> c_int {
            call(instance, |slave| {
                write_output(size, slave.to_bytes(state)?.len());
                Ok(())
            })
        }

        #[unsafe(no_mangle)]
        extern "C" fn $write(
            instance: *mut c_void,
            state: *mut c_void,
            bytes: *mut u8,
            size: usize,
        ) -> c_int {
            call(instance, |slave| slave.write_bytes(state, (bytes, size)))
        }

        #[unsafe(no_mangle)]
        extern "C" fn $read(
            instance: *mut c_void,
            bytes: *const u8,
            size: usize,
            state: *mut *mut c_void,
        ) -> c_int {
            call(instance, |slave| slave.read_bytes((bytes, size), state))
        }
    };
}

/// Defines getters and setters of a type; `$values` is the number of values if it is a separate argument, else that of the references.
macro_rules! values {
    ($get:ident $set:ident: $type:ty, whole $whole:literal, $to:expr, $from:expr; $count:ident $(, $values:ident)?) => {
        #[unsafe(no_mangle)]
        extern "C" fn $get(
            instance: *mut c_void,
            references: *const u32,
            $count: usize,
            values: *mut $type,
            $($values: usize,)?
        ) -> c_int {
            let held = [$count $(, $values)?];
            call(instance, |slave| {
                slave.get((references, $count), (values, held[held.len() - 1]), $whole, $to)
            })
        }

        #[unsafe(no_mangle)]
        extern "C" fn $set(
            instance: *mut c_void,
            references: *const u32,
            $count: usize,
            values: *const $type,
            $($values: usize,)?
        ) -> c_int {
            let held = [$count $(, $values)?];
            call(instance, |slave| {
                slave.set((references, $count), (values, held[held.len() - 1]), $whole, $from)
            })
        }
    };
}

/// Defines functions for types without variables or for unsupported features: an error if any value is requested.
macro_rules! without {
    ($what:literal: $($name:ident)*) => {$(
        // Further C arguments may be ignored with this calling convention.
        #[unsafe(no_mangle)]
        extern "C" fn $name(instance: *mut c_void, references: *const u32, count: usize) -> c_int {
            call(instance, |_| match input_array(references, count)? {
                [] => Ok(()),
                _ => Err(Refusal::new(WrongType, concat!(stringify!($name), ": ", $what))),
            })
        }
    )*};
}

/// Defines functions that this FMU does not support.
macro_rules! refused {
    ($($name:ident)*) => {$(
        // Further C arguments may be ignored with this calling convention.
        #[unsafe(no_mangle)]
        extern "C" fn $name(instance: *mut c_void) -> c_int {
            let message = concat!(stringify!($name), ": this FMU cannot do this");
            call(instance, |_| Err(Refusal::new(UnknownName, message)))
        }
    )*};
}

pub(crate) use {both, refused, values, without};
