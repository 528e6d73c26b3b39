//! Encryption (TLS 1.2 and 1.3), for a server that other computers reach.

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use profidrive::StateFile;
use rustls::ServerConfig;
use rustls::pki_types::pem::PemObject;
use rustls::pki_types::{CertificateDer, PrivateKeyDer};
use tokio::net::TcpStream;
use tokio_rustls::{Accept, TlsAcceptor};

use crate::settings::Certificate;

/// Why a server has no encryption.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TlsError {
    /// A file cannot be read or written.
    #[error("{}: {error}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Why.
        error: io::Error,
    },
    /// Whoever has the key can be this server.
    #[error("{}: other users of this computer can read the key", .0.display())]
    Readable(PathBuf),
    /// A file is not what it has to be.
    #[error("{}: {reason}", path.display())]
    Invalid {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// A certificate could not be made.
    #[error("cannot make a certificate: {0}")]
    Make(String),
}

/// What encrypts the connections of a server.
#[derive(Clone)]
pub(crate) struct Tls {
    acceptor: TlsAcceptor,
    fingerprint: String,
}

impl fmt::Debug for Tls {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Tls").field(&self.fingerprint).finish()
    }
}

impl Tls {
    /// Returns what encrypts a server with these names. A certificate of its own is kept in `folder`, so that a browser that has
    /// accepted it once does so again.
    pub fn new(certificate: &Certificate, names: &[String], folder: Option<&Path>) -> Result<Self, TlsError> {
        match certificate {
            Certificate::SelfSigned => {
                let (pem, file) = (own(names, folder)?, folder.map(own_file).unwrap_or_default());
                Self::of((&pem, &file), (&pem, &file))
            }
            Certificate::Files { certificate, key } => {
                check_private(key)?;
                Self::of((&read(certificate)?, certificate), (&read(key)?, key))
            }
        }
    }

    /// Reads certificates and key, each with the file that it is from.
    fn of((chain, chain_file): (&[u8], &Path), (key, key_file): (&[u8], &Path)) -> Result<Self, TlsError> {
        let invalid = |path: &Path, reason: &dyn fmt::Display| TlsError::Invalid {
            path: path.to_owned(),
            reason: reason.to_string(),
        };
        let chain: Result<Vec<_>, _> = CertificateDer::pem_slice_iter(chain).collect();
        let chain = chain.map_err(|error| invalid(chain_file, &error))?;
        let Some(first) = chain.first() else {
            return Err(invalid(chain_file, &"there is no certificate in it (PEM)"));
        };
        let digest = ring::digest::digest(&ring::digest::SHA256, first);
        let fingerprint: Vec<String> = digest
            .as_ref()
            .iter()
            .map(|octet| format!("{octet:02X}"))
            .collect();
        let key = PrivateKeyDer::from_pem_slice(key).map_err(|error| invalid(key_file, &error))?;
        let provider = Arc::new(rustls::crypto::ring::default_provider());
        let config = ServerConfig::builder_with_provider(provider)
            .with_safe_default_protocol_versions()
            .and_then(|config| config.with_no_client_auth().with_single_cert(chain, key))
            .map_err(|error| invalid(chain_file, &error))?;
        Ok(Self {
            acceptor: TlsAcceptor::from(Arc::new(config)),
            fingerprint: fingerprint.join(":"),
        })
    }

    /// Returns the SHA-256 of the certificate: `AB:CD:..`.
    pub fn fingerprint(&self) -> &str {
        &self.fingerprint
    }

    /// Agrees on encryption with a client.
    pub fn accept(&self, stream: TcpStream) -> Accept<TcpStream> {
        self.acceptor.accept(stream)
    }
}

fn own_file(folder: &Path) -> PathBuf {
    folder.join("certificate.pem")
}

/// Returns the certificate and the key that this server made for itself, in one file of PEM. One of other names is replaced.
fn own(names: &[String], folder: Option<&Path>) -> Result<Vec<u8>, TlsError> {
    // what stands before the first block of PEM is a remark
    let head = format!("{}\n", names.join(" "));
    let kept = folder.map(|folder| StateFile::new(own_file(folder)));
    let failed = |error: profidrive::StateFileError| TlsError::Make(error.to_string());
    if let Some(file) = &kept
        && let Some(before) = file.read().map_err(failed)?
        && before.starts_with(head.as_bytes())
    {
        return Ok(before);
    }
    let made = rcgen::generate_simple_self_signed(names.to_vec());
    let made = made.map_err(|error| TlsError::Make(error.to_string()))?;
    let pem = format!("{head}{}{}", made.cert.pem(), made.signing_key.serialize_pem());
    if let Some(file) = kept {
        file.replace(pem.as_bytes()).map_err(failed)?;
    }
    Ok(pem.into_bytes())
}

fn read(path: &Path) -> Result<Vec<u8>, TlsError> {
    std::fs::read(path).map_err(|error| TlsError::File {
        path: path.to_owned(),
        error,
    })
}

#[cfg(unix)]
fn check_private(path: &Path) -> Result<(), TlsError> {
    use std::os::unix::fs::PermissionsExt;
    let file = path.metadata().map_err(|error| TlsError::File {
        path: path.to_owned(),
        error,
    })?;
    // a group may be that of the web servers
    if file.permissions().mode() & 0o007 != 0 {
        return Err(TlsError::Readable(path.to_owned()));
    }
    Ok(())
}

#[cfg(not(unix))]
fn check_private(_: &Path) -> Result<(), TlsError> {
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(name: &str) -> PathBuf {
        std::env::temp_dir().join(format!("profidrive-tls-{name}-{}", std::process::id()))
    }

    #[test]
    fn a_certificate_is_kept_until_the_names_change() {
        let folder = folder("kept");
        let names = |last: &str| vec!["localhost".to_owned(), last.to_owned()];
        let first = own(&names("192.168.0.5"), Some(&folder)).unwrap();
        assert_eq!(own(&names("192.168.0.5"), Some(&folder)).unwrap(), first);
        assert_ne!(own(&names("192.168.0.6"), Some(&folder)).unwrap(), first);
        let tls = Tls::new(&Certificate::SelfSigned, &names("192.168.0.6"), Some(&folder)).unwrap();
        assert_eq!(tls.fingerprint().len(), 95);
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            let mode = own_file(&folder).metadata().unwrap().permissions().mode();
            assert_eq!(mode & 0o077, 0, "{mode:o}");
        }
        std::fs::remove_dir_all(folder).unwrap();
    }

    #[cfg(unix)]
    #[test]
    fn files_that_others_read_or_that_are_no_pem_are_refused() {
        use std::os::unix::fs::PermissionsExt;
        let folder = folder("files");
        std::fs::create_dir_all(&folder).unwrap();
        let own = own(&["localhost".to_owned()], None).unwrap();
        let (certificate, key) = (folder.join("cert.pem"), folder.join("key.pem"));
        std::fs::write(&certificate, &own).unwrap();
        std::fs::write(&key, &own).unwrap();
        let files = Certificate::Files {
            certificate: certificate.clone(),
            key: key.clone(),
        };
        let mode = |mode| std::fs::set_permissions(&key, std::fs::Permissions::from_mode(mode)).unwrap();
        mode(0o644);
        assert!(matches!(Tls::new(&files, &[], None), Err(TlsError::Readable(path)) if path == key));
        mode(0o640);
        Tls::new(&files, &[], None).unwrap();
        std::fs::write(&certificate, "nothing").unwrap();
        let Err(TlsError::Invalid { path, .. }) = Tls::new(&files, &[], None) else {
            panic!("no certificate")
        };
        assert_eq!(path, certificate);
        std::fs::remove_file(&certificate).unwrap();
        assert!(matches!(Tls::new(&files, &[], None), Err(TlsError::File { .. })));
        std::fs::remove_dir_all(folder).unwrap();
    }
}
