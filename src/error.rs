//! The one error type: what went wrong, in words for the person at the keyboard, and the exit status that follows.

use std::path::{Path, PathBuf};

/// Result of everything that can fail.
pub type Result<T> = std::result::Result<T, Error>;

/// Why a command stopped.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The input is at fault. The message is complete as it stands, usually several lines that begin with `error:`:
    /// what is wrong, file:line:column with the offending line, what was expected, what to do.
    #[error("{0}")]
    Input(String),
    /// The operating system refused a file.
    #[error("error: cannot {action} `{}`: {}\n  = help: {}", path.display(), source, advice(source.kind()))]
    Io {
        /// What was attempted, e.g. `read`, `write`, `create the folder`.
        action: &'static str,
        /// On which path.
        path: PathBuf,
        /// What the operating system said.
        source: std::io::Error,
    },
    /// The work could not be finished (no convergence, out of time).
    #[error("error: {0}")]
    Unfinished(String),
    /// Everything was done and written, and a gate failed; the text lists which.
    #[error("{0}")]
    Gate(String),
    /// The user interrupted the work.
    #[error("error: interrupted; files written before are whole")]
    Interrupted,
}

impl Error {
    /// An [`Error::Io`] in `map_err` form.
    pub fn io(action: &'static str, path: impl AsRef<Path>) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.as_ref().to_path_buf();
        move |source| Self::Io { action, path, source }
    }

    /// Exit status: 1 for a gate that failed, 2 for bad usage or input (a file that cannot be read included), 3 where
    /// the work could not be finished.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Gate(_) => 1,
            Self::Input(_) => 2,
            Self::Io { action, .. } if action.starts_with("read") => 2,
            Self::Io { .. } | Self::Unfinished(_) | Self::Interrupted => 3,
        }
    }
}

fn advice(kind: std::io::ErrorKind) -> &'static str {
    use std::io::ErrorKind as K;
    match kind {
        K::NotFound => "check the spelling of the path and the current folder",
        K::PermissionDenied => "check the permissions of the file and of its folder",
        K::StorageFull => "free some space or choose another folder",
        K::ReadOnlyFilesystem => "choose a folder that can be written to",
        K::NotADirectory | K::IsADirectory => "a file stands where a folder is needed, or the reverse",
        _ => "check that the path is an ordinary file or folder that you may use",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exit_codes_follow_the_interface() {
        let io = |action| Error::io(action, "x")(std::io::ErrorKind::NotFound.into());
        assert_eq!(Error::Input(String::new()).exit_code(), 2);
        assert_eq!(io("read").exit_code(), 2);
        assert_eq!(io("write").exit_code(), 3);
        assert_eq!(Error::Unfinished(String::new()).exit_code(), 3);
        assert_eq!(Error::Interrupted.exit_code(), 3);
        assert_eq!(Error::Gate(String::new()).exit_code(), 1);
    }
}
