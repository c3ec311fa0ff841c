//! Opening a library: a copy of its file, its hash, its table.
#![allow(unsafe_code, reason = "another program's code is called")]

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::SystemTime;

use brdf_sdk::native::abi;
use brdf_sdk::{Problem, Result};
use sha2::{Digest, Sha256};

/// An opened library.
#[derive(Clone, Copy)]
pub struct Library {
    /// The hash of its file, or of its name where it is a part of the program.
    pub id: [u8; 32],
    /// What it exports.
    pub table: &'static abi::Plugin,
}

/// A file as it was when it was opened.
struct Opened {
    file: PathBuf,
    /// Its size and time: whoever writes it again changes one of them.
    stamp: (u64, SystemTime),
    library: Library,
}

/// The files that were opened. Libraries are never closed: arrays and threads of theirs may still be about.
static OPENED: Mutex<Vec<Opened>> = Mutex::new(Vec::new());

/// What the system calls the library of that name; a folder before the name stays.
pub fn file_name(name: &str) -> PathBuf {
    let (folder, name) = name.rsplit_once('/').unwrap_or(("", name));
    let (prefix, suffix) = (std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    Path::new(folder).join(format!("{prefix}{name}{suffix}"))
}

/// The SHA-256 of a file's content, in hexadecimal digits.
pub fn hexadecimal(hash: [u8; 32]) -> String {
    hash.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// The SHA-256 of a file's content.
pub fn hash(file: &Path) -> Result<[u8; 32]> {
    Ok(Sha256::digest(read(file)?).into())
}

fn read(file: &Path) -> Result<Vec<u8>> {
    fs::read(file).map_err(|error| {
        Problem::new(
            file.display().to_string(),
            format!("the library cannot be read ({error})"),
            "build it again, or check its permissions",
        )
    })
}

/// A table that is a part of the program.
pub fn checked(table: &'static abi::Plugin, name: &str) -> Result<Library> {
    check_version(table.version, table.size, name)?;
    Ok(Library { id: Sha256::digest(name).into(), table })
}

/// Opens a copy of the file as it is now, if `allow` allows its hash; a file that was opened and has not been
/// written since is not read again.
pub fn open(file: &Path, allow: impl FnOnce([u8; 32]) -> Result<()>) -> Result<Library> {
    let stamp =
        fs::metadata(file).ok().and_then(|known| Some((known.len(), known.modified().ok()?)));
    let mut opened = OPENED.lock().unwrap_or_else(PoisonError::into_inner);
    let same = |known: &&Opened| known.file == file && Some(known.stamp) == stamp;
    if let Some(known) = opened.iter().find(same) {
        return Ok(known.library);
    }
    let bytes = read(file)?;
    let id: [u8; 32] = Sha256::digest(&bytes).into();
    allow(id)?;
    let library = match opened.iter().find(|known| known.library.id == id) {
        Some(known) => known.library,
        None => Library { id, table: open_copy(file, &bytes, &file.display().to_string())? },
    };
    if let Some(stamp) = stamp {
        opened.push(Opened { file: file.to_owned(), stamp, library });
    }
    Ok(library)
}

/// Systems give the old code for a path that is open already; a fresh name gives the new one. The bytes that
/// were hashed are the bytes that run.
fn open_copy(file: &Path, bytes: &[u8], shown: &str) -> Result<&'static abi::Plugin> {
    if is_cut(bytes) {
        return Err(Problem::new(
            shown,
            "the library ends before its code does",
            "wait until it is built, or build it again",
        ));
    }
    let copying = |error: std::io::Error| {
        Problem::new(
            shown,
            format!("its copy cannot be written ({error})"),
            "free space in the folder of temporary files",
        )
    };
    let folder = tempfile::Builder::new().prefix("brdf-native").tempdir().map_err(copying)?;
    let copy = folder.path().join(file.file_name().unwrap_or_default());
    fs::write(&copy, bytes).map_err(copying)?;
    // SAFETY: whoever trusts a library trusts what it does on being opened.
    let opened = unsafe { libloading::Library::new(&copy) }.map_err(|error| {
        Problem::new(
            shown,
            format!("the system cannot load it ({})", reason(&error, &copy)),
            "build it for this machine and system, with all that it needs beside it",
        )
    })?;
    // SAFETY: the symbol is a static table that begins with its version, whatever that is; no more than the
    // version is read until it is known to be ours.
    let version = unsafe {
        let symbol = opened.get::<*const u32>(abi::SYMBOL);
        let symbol = symbol.map_err(|_| {
            Problem::new(
                shown,
                "it exports no plugin (there is no symbol BRDF_PLUGIN)",
                "write `brdf_sdk::export_plugin!(Type, \"name 1.0\");` in it",
            )
        })?;
        symbol.read_unaligned()
    };
    check_version(version, size_of::<abi::Plugin>() as u32, shown)?;
    // SAFETY: it says that its table is the one of this version, and it stays mapped for good.
    let table: &'static abi::Plugin = unsafe {
        let symbol = opened.get::<*const abi::Plugin>(abi::SYMBOL);
        let table =
            symbol.map_err(|error| Problem::new(shown, error.to_string(), "build it again"))?;
        &**table
    };
    check_version(table.version, table.size, shown)?;
    std::mem::forget(opened);
    // Where the system lets go of the name, the copy goes now; elsewhere the folder stays behind.
    let _ = fs::remove_file(&copy);
    Ok(table)
}

/// Whether an ELF file's segments go on behind its end: systems map such a file, and the program dies when it
/// looks there. Words lie as the file says; 64 bits alone, as this program is built for.
fn is_cut(bytes: &[u8]) -> bool {
    let word = |at: usize, size: usize| {
        let own = bytes.get(at..at.checked_add(size)?)?;
        let most_first = bytes[5] == 2;
        let add = |word: u64, byte: &u8| word << 8 | u64::from(*byte);
        Some(if most_first { own.iter().fold(0, add) } else { own.iter().rev().fold(0, add) })
    };
    if !bytes.starts_with(b"\x7fELF\x02") {
        return false;
    }
    // e_phoff, e_phentsize, e_phnum; of each program header p_offset and p_filesz.
    let (Some(first), Some(size), Some(count)) = (word(32, 8), word(54, 2), word(56, 2)) else {
        return true;
    };
    (0..count).any(|n| {
        let end = first.checked_add(n * size).and_then(|header| {
            let header = usize::try_from(header).ok()?;
            word(header.checked_add(8)?, 8)?.checked_add(word(header.checked_add(32)?, 8)?)
        });
        end.is_none_or(|end| end > bytes.len() as u64)
    })
}

fn check_version(version: u32, size: u32, shown: &str) -> Result<()> {
    let own = size_of::<abi::Plugin>();
    let reason = match version == abi::VERSION {
        true if size as usize == own => return Ok(()),
        true => format!("its table has {size} bytes and not {own}"),
        false => format!(
            "it was built for version {version} of the native interface, and this program speaks version {}",
            abi::VERSION
        ),
    };
    let cure = format!("build it again with brdf-sdk {}", env!("CARGO_PKG_VERSION"));
    Err(Problem::new(shown, reason, cure))
}

/// The system's words on one line, without the copy's path.
fn reason(error: &libloading::Error, copy: &Path) -> String {
    use std::error::Error;
    let mut text = error.to_string();
    let mut source = error.source();
    while let Some(inner) = source {
        text = inner.to_string();
        source = inner.source();
    }
    let text = text.replace(&*copy.to_string_lossy(), "");
    text.trim_start_matches([':', ' ']).split_whitespace().collect::<Vec<_>>().join(" ")
}
