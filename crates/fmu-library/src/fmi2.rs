//! FMI 2.0 for co-simulation.
#![expect(
    unsafe_code,
    reason = "C finds these functions by their names, and hands over pointers"
)]

use std::ffi::{c_char, c_int, c_void};

use cvtcycle_fmu::ProblemKind::{Syntax, UnknownName, WrongType};
use cvtcycle_fmu::Refusal;

use crate::both::{both, refused, values, without};
use crate::slave::{
    ERROR, Instantiation, Log2, Logger, call, free, input_array, instantiate, write_output,
};

/// `fmi2CallbackFunctions`, of which only the logger is used.
#[repr(C)]
struct Callbacks {
    logger: Option<Log2>,
    allocate_memory: *const c_void,
    free_memory: *const c_void,
    step_finished: *const c_void,
    environment: *mut c_void,
}

/// `fmi2CoSimulation`.
const CO_SIMULATION: c_int = 1;

/// Decodes the folder of a URI `file:///PATH`.
fn folder(uri: &str) -> Result<String, Refusal> {
    let rest = uri
        .strip_prefix("file://localhost/")
        .map(|path| format!("/{path}"));
    let rest = rest.or_else(|| uri.strip_prefix("file://").map(str::to_owned));
    // Some masters write a single slash.
    let rest = rest.or_else(|| uri.strip_prefix("file:").map(str::to_owned));
    let Some(path) = rest else {
        let message = format!("the location of the resources `{uri}` is no file:// URI");
        return Err(Refusal::new(Syntax, message));
    };
    let mut bytes = Vec::with_capacity(path.len());
    let mut rest = path.as_bytes();
    while let Some((byte, after)) = rest.split_first() {
        let digits = after.get(..2).filter(|_| *byte == b'%');
        let digits = digits.and_then(|digits| std::str::from_utf8(digits).ok());
        match digits.and_then(|digits| u8::from_str_radix(digits, 16).ok()) {
            Some(decoded) => {
                bytes.push(decoded);
                rest = &after[2..];
            }
            None => {
                bytes.push(*byte);
                rest = after;
            }
        }
    }
    let path = String::from_utf8_lossy(&bytes).into_owned();
    // file:///C:/folder has the path C:/folder.
    let is_drive = path.as_bytes().get(2) == Some(&b':');
    Ok(match path.strip_prefix('/').filter(|_| is_drive) {
        Some(path) => path.to_owned(),
        None => path,
    })
}

#[unsafe(no_mangle)]
extern "C" fn fmi2GetTypesPlatform() -> *const c_char {
    c"default".as_ptr()
}

#[unsafe(no_mangle)]
extern "C" fn fmi2GetVersion() -> *const c_char {
    c"2.0".as_ptr()
}

#[unsafe(no_mangle)]
extern "C" fn fmi2SetDebugLogging(
    instance: *mut c_void,
    _on: c_int,
    _count: usize,
    _categories: *const *const c_char,
) -> c_int {
    // There is no debug logging; errors are always logged.
    call(instance, |_| Ok(()))
}

#[unsafe(no_mangle)]
extern "C" fn fmi2Instantiate(
    name: *const c_char,
    kind: c_int,
    token: *const c_char,
    resources: *const c_char,
    callbacks: *const c_void,
    _visible: c_int,
    _logging: c_int,
) -> *mut c_void {
    // SAFETY: null, or the structure of the standard, which outlives the instance.
    let callbacks = unsafe { callbacks.cast::<Callbacks>().as_ref() };
    let logger = callbacks.map_or(Logger::Fmi2(None, std::ptr::null_mut()), |own| {
        Logger::Fmi2(own.logger, own.environment)
    });
    let arguments = Instantiation {
        name,
        token,
        resources,
        logger,
    };
    if kind != CO_SIMULATION {
        logger.log(c"", ERROR, "this FMU is for co-simulation only");
        return std::ptr::null_mut();
    }
    instantiate(&arguments, folder)
}

#[unsafe(no_mangle)]
extern "C" fn fmi2SetupExperiment(
    instance: *mut c_void,
    _tolerance_defined: c_int,
    _tolerance: f64,
    start_s: f64,
    _stop_defined: c_int,
    _stop_s: f64,
) -> c_int {
    call(instance, |slave| {
        slave.start_s = start_s;
        Ok(())
    })
}

#[unsafe(no_mangle)]
extern "C" fn fmi2EnterInitializationMode(instance: *mut c_void) -> c_int {
    call(instance, |_| Ok(()))
}

#[unsafe(no_mangle)]
extern "C" fn fmi2DoStep(
    instance: *mut c_void,
    from_s: f64,
    step_s: f64,
    _no_state_set_before: c_int,
) -> c_int {
    call(instance, |slave| slave.unit.step(from_s, step_s))
}

both! {
    free: fmi2FreeInstance, end_initialization: fmi2ExitInitializationMode, terminate: fmi2Terminate, reset: fmi2Reset,
    save: fmi2GetFMUstate, restore: fmi2SetFMUstate, free_state: fmi2FreeFMUstate,
    size: fmi2SerializedFMUstateSize, write: fmi2SerializeFMUstate, read: fmi2DeSerializeFMUstate,
}
values!(fmi2GetReal fmi2SetReal: f64, whole false, |x| x, |x| x; count);
values!(fmi2GetInteger fmi2SetInteger: c_int, whole true, |x| x as c_int, f64::from; count);

without!("no variable of this FMU has this type": fmi2GetBoolean fmi2GetString fmi2SetBoolean fmi2SetString);
without!("this FMU has no derivatives": fmi2SetRealInputDerivatives fmi2GetRealOutputDerivatives);

refused!(fmi2GetDirectionalDerivative fmi2CancelStep fmi2GetStatus fmi2GetRealStatus fmi2GetIntegerStatus fmi2GetBooleanStatus fmi2GetStringStatus);
