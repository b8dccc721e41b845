//! Opens a GeoPackage with the database engine, and says what its refusals mean.
//!
//! Another program may be writing to the file. It then holds a lock, and the engine waits for it for a while. A program that
//! was killed while it wrote leaves a journal beside the file. The next program that opens the file takes the unfinished
//! changes back. The engine does so only if it may write, so a file that is only to be read is opened twice.

use std::path::Path;
use std::time::Duration;

use rusqlite::{Connection, ErrorCode, OpenFlags};

use tokosen_core::base::error::Error;

/// How long to wait for another program that writes to the file.
const PATIENCE: Duration = Duration::from_secs(10);

/// Opens a file to read it, as a whole: without the changes of a program that was killed while it wrote.
pub(super) fn open_to_read(path: &Path) -> rusqlite::Result<Connection> {
    let look = |db: &Connection| db.query_row("SELECT count(*) FROM sqlite_master", [], |_| Ok(()));
    let db = open(path, OpenFlags::SQLITE_OPEN_READ_ONLY)?;
    match look(&db) {
        Err(e) if e.sqlite_error_code() == Some(ErrorCode::ReadOnly) => {
            drop(db);
            look(&open_to_write(path)?)?;
            open(path, OpenFlags::SQLITE_OPEN_READ_ONLY)
        }
        // The engine has waited, and would wait again.
        Err(e) if is_locked(&e) => Err(e),
        // The caller meets it again, and says what it means there.
        _ => Ok(db),
    }
}

/// Opens a file that exists to write to it.
pub(super) fn open_to_write(path: &Path) -> rusqlite::Result<Connection> {
    open(path, OpenFlags::SQLITE_OPEN_READ_WRITE)
}

fn open(path: &Path, mode: OpenFlags) -> rusqlite::Result<Connection> {
    let db = Connection::open_with_flags(path, mode | OpenFlags::SQLITE_OPEN_NO_MUTEX)?;
    db.busy_timeout(PATIENCE)?;
    Ok(db)
}

/// Whether another program holds the file.
pub(super) fn is_locked(error: &rusqlite::Error) -> bool {
    matches!(error.sqlite_error_code(), Some(ErrorCode::DatabaseBusy | ErrorCode::DatabaseLocked))
}

/// Whether the file has unfinished changes of a program that was killed, and they cannot be taken back because the file or
/// its folder is write-protected.
fn is_unfinished(error: &rusqlite::Error) -> bool {
    error.sqlite_error_code() == Some(ErrorCode::ReadOnly)
}

/// Whether the error says nothing about the content of the file: it may well be a GeoPackage.
pub(super) fn is_about_access(error: &rusqlite::Error) -> bool {
    is_locked(error)
        || is_unfinished(error)
        || matches!(error.sqlite_error_code(), Some(ErrorCode::CannotOpen | ErrorCode::PermissionDenied))
}

/// The error in words. `otherwise` is the message if the cause is neither a lock nor unfinished changes.
pub(super) fn in_words(path: &Path, otherwise: &str, error: rusqlite::Error) -> Error {
    let message = if is_locked(&error) {
        "is locked by another program; close it there, or wait until that program is done, and try again"
    } else if is_unfinished(&error) {
        "has unfinished changes of a program that was stopped, and is write-protected; take the protection off, or copy it \
         with the file '-journal' or '-wal' beside it"
    } else {
        otherwise
    };
    Error::file_cause(path, message, error)
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    /// A file as a program leaves it that was killed while it wrote: half of the changes are in it, and a journal beside it
    /// has what was there before.
    pub(in crate::gpkg) fn left_by_a_killed_program(path: &Path) {
        let working = path.with_extension("working");
        let db = Connection::open(&working).unwrap();
        db.execute_batch(
            "PRAGMA cache_size = 2; CREATE TABLE t (a TEXT);
             WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < 2000)
             INSERT INTO t SELECT 'before ' || i FROM n;
             BEGIN; UPDATE t SET a = 'after, and longer than it was before';",
        )
        .unwrap();
        let journal = |path: &Path| std::path::PathBuf::from(format!("{}-journal", path.display()));
        fs::copy(&working, path).unwrap();
        fs::copy(journal(&working), journal(path)).unwrap();
        drop(db);
        fs::remove_file(working).unwrap();
    }

    #[test]
    fn unfinished_changes_are_taken_back() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.gpkg");
        left_by_a_killed_program(&path);
        let plain = open(&path, OpenFlags::SQLITE_OPEN_READ_ONLY).unwrap();
        let count = "SELECT count(*) FROM t WHERE a LIKE 'before %'";
        let error = plain.query_row(count, [], |row| row.get::<_, i64>(0)).unwrap_err();
        assert!(is_unfinished(&error), "otherwise this test tests nothing: {error}");
        drop(plain);
        let db = open_to_read(&path).unwrap();
        assert_eq!(db.query_row(count, [], |row| row.get::<_, i64>(0)), Ok(2000));
    }
}
