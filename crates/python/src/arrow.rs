//! Arrow C data interface: hands a table of owned columns to any reader as one record batch, without a copy.
//!
//! Structs, fields, and the duties of producer and consumer are those of the specification
//! (<https://arrow.apache.org/docs/format/CDataInterface.html>, CStreamInterface.html). The box behind the `private` field owns the
//! data of a struct: that of a column holds a reference to its cells, so that they live as long as any reader has the struct.
//! `release` drops the box once and clears itself. A consumer may move a struct, since nothing points to the struct itself.
#![expect(
    unsafe_code,
    reason = "the interface is one of C: raw pointers, callbacks"
)]

use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::ptr::{null, null_mut};
use std::sync::Arc;

use crate::table::{Cells, TableColumn};

/// Name of the capsule of a stream.
pub const STREAM: &CStr = c"arrow_array_stream";
/// Name of the capsule of a schema.
pub const SCHEMA: &CStr = c"arrow_schema";
/// Flag of a nullable field.
const NULLABLE: i64 = 2;

/// `struct ArrowSchema`.
#[repr(C)]
pub struct Schema {
    format: *const c_char,
    name: *const c_char,
    metadata: *const c_char,
    flags: i64,
    n_children: i64,
    children: *mut *mut Schema,
    dictionary: *mut Schema,
    release: Option<unsafe extern "C" fn(*mut Schema)>,
    private: *mut c_void,
}

/// `struct ArrowArray`.
#[repr(C)]
pub struct Array {
    length: i64,
    null_count: i64,
    offset: i64,
    n_buffers: i64,
    n_children: i64,
    buffers: *mut *const c_void,
    children: *mut *mut Array,
    dictionary: *mut Array,
    release: Option<unsafe extern "C" fn(*mut Array)>,
    private: *mut c_void,
}

/// `struct ArrowArrayStream`.
#[repr(C)]
pub struct Stream {
    get_schema: unsafe extern "C" fn(*mut Stream, *mut Schema) -> c_int,
    get_next: unsafe extern "C" fn(*mut Stream, *mut Array) -> c_int,
    get_last_error: unsafe extern "C" fn(*mut Stream) -> *const c_char,
    release: Option<unsafe extern "C" fn(*mut Stream)>,
    private: *mut c_void,
}

// SAFETY: all pointers of these structs lead to data owned by their boxes, which hold `Send` data only.
unsafe impl Send for Schema {}
// SAFETY: as above.
unsafe impl Send for Array {}
// SAFETY: as above.
unsafe impl Send for Stream {}

/// Data owned by a schema.
struct SchemaOwner {
    format: CString,
    name: CString,
    metadata: Vec<u8>,
    /// One box per child, as a consumer may take a single one.
    children: Box<[*mut Schema]>,
}

/// Data owned by an array.
struct ArrayOwner {
    _cells: Option<Cells>,
    buffers: Box<[*const c_void]>,
    children: Box<[*mut Array]>,
}

/// Data owned by a stream.
struct StreamOwner {
    columns: Arc<Vec<TableColumn>>,
    is_done: bool,
}

/// Key and value pairs in the encoding of the interface: counts and lengths as native int32, then bytes.
fn metadata(pairs: &[(&str, &str)]) -> Vec<u8> {
    let count = |n: usize| i32::try_from(n).unwrap_or(i32::MAX).to_ne_bytes();
    let mut out = count(pairs.len()).to_vec();
    for text in pairs.iter().flat_map(|(key, value)| [key, value]) {
        out.extend_from_slice(&count(text.len()));
        out.extend_from_slice(text.as_bytes());
    }
    out
}

fn raw<T>(list: impl Iterator<Item = T>) -> Box<[*mut T]> {
    list.map(|one| Box::into_raw(Box::new(one))).collect()
}

fn schema(format: &CStr, name: &str, pairs: &[(&str, &str)], children: Vec<Schema>) -> Schema {
    let mut owner = Box::new(SchemaOwner {
        format: format.to_owned(),
        name: CString::new(name).unwrap_or_default(),
        metadata: if pairs.is_empty() {
            Vec::new()
        } else {
            metadata(pairs)
        },
        children: raw(children.into_iter()),
    });
    Schema {
        format: owner.format.as_ptr(),
        name: owner.name.as_ptr(),
        metadata: match owner.metadata.is_empty() {
            true => null(),
            false => owner.metadata.as_ptr().cast(),
        },
        flags: NULLABLE,
        n_children: owner.children.len() as i64,
        children: owner.children.as_mut_ptr(),
        dictionary: null_mut(),
        release: Some(release_schema),
        private: Box::into_raw(owner).cast(),
    }
}

fn array(length: usize, cells: Option<Cells>, children: Vec<Array>) -> Array {
    // The first buffer would be the validity bitmap; no cell is missing.
    let buffers: Vec<*const c_void> = match &cells {
        None => vec![null()],
        Some(Cells::Number(cells)) => vec![null(), cells.as_ptr().cast()],
        Some(Cells::Count(cells)) => vec![null(), cells.as_ptr().cast()],
        Some(Cells::Text(words)) => vec![
            null(),
            words.ends.as_ptr().cast(),
            words.bytes.as_ptr().cast(),
        ],
    };
    let mut owner = Box::new(ArrayOwner {
        _cells: cells,
        buffers: buffers.into(),
        children: raw(children.into_iter()),
    });
    Array {
        length: length as i64,
        null_count: 0,
        offset: 0,
        n_buffers: owner.buffers.len() as i64,
        n_children: owner.children.len() as i64,
        buffers: owner.buffers.as_mut_ptr(),
        children: owner.children.as_mut_ptr(),
        dictionary: null_mut(),
        release: Some(release_array),
        private: Box::into_raw(owner).cast(),
    }
}

/// Schema of a table: a struct of its columns, with unit and meaning of each.
pub fn table_schema(columns: &[TableColumn]) -> Schema {
    let child = |column: &TableColumn| {
        let format = match column.cells {
            Cells::Number(_) => c"g",
            Cells::Count(_) => c"l",
            Cells::Text(_) => c"U",
        };
        let pairs = [("unit", column.unit.as_str()), ("doc", column.doc.as_str())];
        schema(format, &column.name, &pairs, Vec::new())
    };
    schema(c"+s", "", &[], columns.iter().map(child).collect())
}

/// Stream of a table as one record batch.
pub fn table_stream(columns: Arc<Vec<TableColumn>>) -> Stream {
    let owner = StreamOwner {
        columns,
        is_done: false,
    };
    Stream {
        get_schema,
        get_next,
        get_last_error,
        release: Some(release_stream),
        private: Box::into_raw(Box::new(owner)).cast(),
    }
}

unsafe extern "C" fn release_schema(schema: *mut Schema) {
    // SAFETY: called once with a valid schema made by `schema`, whose private field is the box made there; each child is a box of its own,
    // released already where a consumer has taken it.
    unsafe {
        let owner = Box::from_raw((*schema).private.cast::<SchemaOwner>());
        for child in &owner.children {
            drop(Box::from_raw(*child));
        }
        (*schema).release = None;
    }
}

unsafe extern "C" fn release_array(array: *mut Array) {
    // SAFETY: as that of a schema, with the box made by `array`.
    unsafe {
        let owner = Box::from_raw((*array).private.cast::<ArrayOwner>());
        for child in &owner.children {
            drop(Box::from_raw(*child));
        }
        (*array).release = None;
    }
}

unsafe extern "C" fn get_schema(stream: *mut Stream, out: *mut Schema) -> c_int {
    // SAFETY: the stream is one of `table_stream` and not released; `out` is room for a schema, which may be uninitialised.
    unsafe {
        let owner = &*(*stream).private.cast::<StreamOwner>();
        out.write(table_schema(&owner.columns));
    }
    0
}

unsafe extern "C" fn get_next(stream: *mut Stream, out: *mut Array) -> c_int {
    // SAFETY: as that of `get_schema`; a consumer calls from one thread at a time, so that the reference is the only one.
    unsafe {
        let owner = &mut *(*stream).private.cast::<StreamOwner>();
        if std::mem::replace(&mut owner.is_done, true) {
            // An array without `release` marks the end.
            (&raw mut (*out).release).write(None);
            return 0;
        }
        let child = |column: &TableColumn| {
            let cells = column.cells.clone();
            array(cells.len(), Some(cells), Vec::new())
        };
        let children = owner.columns.iter().map(child).collect();
        let rows = owner.columns.first().map_or(0, |column| column.cells.len());
        out.write(array(rows, None, children));
    }
    0
}

unsafe extern "C" fn get_last_error(_: *mut Stream) -> *const c_char {
    // No call can fail.
    null()
}

unsafe extern "C" fn release_stream(stream: *mut Stream) {
    // SAFETY: called once with a stream of `table_stream`, whose private field is the box made there.
    unsafe {
        drop(Box::from_raw((*stream).private.cast::<StreamOwner>()));
        (*stream).release = None;
    }
}

macro_rules! released {
    ($($of:ty),*) => {
        $(impl Drop for $of {
            fn drop(&mut self) {
                if let Some(release) = self.release {
                    // SAFETY: a struct with `release` has not been released, and nothing uses it after this.
                    unsafe { release(self) }
                }
            }
        })*
    };
}

// Covers capsules without a consumer and children that no consumer has taken.
released!(Schema, Array, Stream);
