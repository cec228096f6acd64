//! FMI 3.0 for co-simulation.
#![expect(
    unsafe_code,
    reason = "C finds these functions by their names, and hands over pointers"
)]

use std::ffi::{c_char, c_int, c_void};

use cvtcycle_fmu::ProblemKind::{UnknownName, WrongType};
use cvtcycle_fmu::Refusal;

use crate::both::{both, refused, values, without};
use crate::slave::{
    Instantiation, Log3, Logger, call, free, input_array, instantiate, write_output,
};

fn folder(path: &str) -> Result<String, Refusal> {
    Ok(path.to_owned())
}

#[unsafe(no_mangle)]
extern "C" fn fmi3GetVersion() -> *const c_char {
    c"3.0".as_ptr()
}

#[unsafe(no_mangle)]
extern "C" fn fmi3SetDebugLogging(
    instance: *mut c_void,
    _on: bool,
    _count: usize,
    _categories: *const *const c_char,
) -> c_int {
    // There is no debug logging; errors are always logged.
    call(instance, |_| Ok(()))
}

#[unsafe(no_mangle)]
extern "C" fn fmi3InstantiateCoSimulation(
    name: *const c_char,
    token: *const c_char,
    resources: *const c_char,
    _visible: bool,
    _logging: bool,
    _event_mode: bool,
    _early_return: bool,
    _intermediate: *const u32,
    _intermediate_count: usize,
    environment: *mut c_void,
    logger: Option<Log3>,
    _intermediate_update: *const c_void,
) -> *mut c_void {
    let arguments = Instantiation {
        name,
        token,
        resources,
        logger: Logger::Fmi3(logger, environment),
    };
    instantiate(&arguments, folder)
}

#[unsafe(no_mangle)]
extern "C" fn fmi3EnterInitializationMode(
    instance: *mut c_void,
    _tolerance_defined: bool,
    _tolerance: f64,
    start_s: f64,
    _stop_defined: bool,
    _stop_s: f64,
) -> c_int {
    call(instance, |slave| {
        slave.start_s = start_s;
        Ok(())
    })
}

#[unsafe(no_mangle)]
extern "C" fn fmi3DoStep(
    instance: *mut c_void,
    from_s: f64,
    step_s: f64,
    _no_state_set_before: bool,
    event: *mut bool,
    terminate: *mut bool,
    early_return: *mut bool,
    last_s: *mut f64,
) -> c_int {
    write_output(event, false);
    write_output(terminate, false);
    write_output(early_return, false);
    call(instance, |slave| {
        let stepped = slave.unit.step(from_s, step_s);
        write_output(last_s, slave.unit.time_s());
        stepped
    })
}

both! {
    free: fmi3FreeInstance, end_initialization: fmi3ExitInitializationMode, terminate: fmi3Terminate, reset: fmi3Reset,
    save: fmi3GetFMUState, restore: fmi3SetFMUState, free_state: fmi3FreeFMUState,
    size: fmi3SerializedFMUStateSize, write: fmi3SerializeFMUState, read: fmi3DeserializeFMUState,
}
values!(fmi3GetFloat64 fmi3SetFloat64: f64, whole false, |x| x, |x| x; count, value_count);
values!(fmi3GetInt32 fmi3SetInt32: i32, whole true, |x| x as i32, f64::from; count, value_count);

without!(
    "no variable of this FMU has this type":
    fmi3GetFloat32 fmi3GetInt8 fmi3GetUInt8 fmi3GetInt16 fmi3GetUInt16 fmi3GetUInt32 fmi3GetInt64 fmi3GetUInt64
    fmi3GetBoolean fmi3GetString fmi3GetBinary fmi3GetClock
    fmi3SetFloat32 fmi3SetInt8 fmi3SetUInt8 fmi3SetInt16 fmi3SetUInt16 fmi3SetUInt32 fmi3SetInt64 fmi3SetUInt64
    fmi3SetBoolean fmi3SetString fmi3SetBinary fmi3SetClock
);

refused!(
    fmi3EnterEventMode fmi3EnterStepMode fmi3EnterConfigurationMode fmi3ExitConfigurationMode
    fmi3GetNumberOfVariableDependencies fmi3GetVariableDependencies fmi3GetDirectionalDerivative fmi3GetAdjointDerivative
    fmi3GetIntervalDecimal fmi3GetIntervalFraction fmi3GetShiftDecimal fmi3GetShiftFraction
    fmi3SetIntervalDecimal fmi3SetIntervalFraction fmi3SetShiftDecimal fmi3SetShiftFraction
    fmi3EvaluateDiscreteStates fmi3UpdateDiscreteStates fmi3GetOutputDerivatives
    fmi3EnterContinuousTimeMode fmi3CompletedIntegratorStep fmi3SetTime fmi3SetContinuousStates
    fmi3GetContinuousStateDerivatives fmi3GetEventIndicators fmi3GetContinuousStates fmi3GetNominalsOfContinuousStates
    fmi3GetNumberOfEventIndicators fmi3GetNumberOfContinuousStates fmi3ActivateModelPartition
);

/// Defines instantiation of unsupported kinds of FMU: always null.
macro_rules! no_instance {
    ($($name:ident)*) => {$(
        #[unsafe(no_mangle)]
        extern "C" fn $name() -> *mut c_void {
            std::ptr::null_mut()
        }
    )*};
}

no_instance!(fmi3InstantiateModelExchange fmi3InstantiateScheduledExecution);
