//! A depot in a bucket: S3 and what speaks its language, Azure, Google, or whatever else `object_store` has.

use std::io;
use std::sync::Arc;

use object_store::path::Path;
use object_store::{Error, ObjectStore, ObjectStoreExt, PutMode, PutOptions};
use tokio::runtime::Runtime;
use tokio::task::JoinSet;

use super::{Depot, DepotError, Settings};

/// Objects under an address. Requests that fail on the way are tried again by `object_store`.
pub(super) struct Bucket {
    address: String,
    prefix: Path,
    objects: Arc<dyn ObjectStore>,
    runtime: Runtime,
}

impl Bucket {
    /// The bucket at an address; it has to exist. The first use finds out whether it does.
    pub(super) fn open(address: &str, settings: &Settings) -> Result<Self, DepotError> {
        let failed = |error| DepotError { place: address.to_owned(), error };
        let url = url::Url::parse(address).map_err(|error| failed(io::Error::other(error)))?;
        let settings = settings.iter().map(|(name, value)| (name, value));
        let (objects, prefix) =
            object_store::parse_url_opts(&url, settings).map_err(|error| failed(error.into()))?;
        // Requests wait for the network, not for a processor.
        let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(1).enable_all().build();
        let runtime = runtime.map_err(failed)?;
        Ok(Self { address: address.to_owned(), prefix, objects: objects.into(), runtime })
    }

    fn path(&self, name: &str) -> Path {
        name.split('/').fold(self.prefix.clone(), |path, part| path.join(part))
    }

    fn failed(&self, name: &str) -> impl FnOnce(Error) -> DepotError {
        let place = format!("{}/{name}", self.address.trim_end_matches('/'));
        move |error| DepotError { place, error: error.into() }
    }

    fn put_as(&self, name: &str, bytes: &[u8], mode: PutMode) -> Result<(), Error> {
        let path = self.path(name);
        let put = self.objects.put_opts(&path, bytes.to_vec().into(), PutOptions::from(mode));
        self.runtime.block_on(put).map(drop)
    }
}

/// What a removal says when there was nothing to remove.
fn unless_gone(result: Result<(), Error>) -> Result<(), Error> {
    match result {
        Err(Error::NotFound { .. }) => Ok(()),
        result => result,
    }
}

impl Depot for Bucket {
    fn get(&self, name: &str) -> Result<Option<Vec<u8>>, DepotError> {
        let path = self.path(name);
        let got = self.runtime.block_on(async { self.objects.get(&path).await?.bytes().await });
        match got {
            Ok(bytes) => Ok(Some(bytes.to_vec())),
            Err(Error::NotFound { .. }) => Ok(None),
            Err(error) => Err(self.failed(name)(error)),
        }
    }

    fn put(&self, name: &str, bytes: &[u8]) -> Result<(), DepotError> {
        self.put_as(name, bytes, PutMode::Overwrite).map_err(self.failed(name))
    }

    fn put_new(&self, name: &str, bytes: &[u8]) -> Result<bool, DepotError> {
        match self.put_as(name, bytes, PutMode::Create) {
            Ok(()) => Ok(true),
            Err(Error::AlreadyExists { .. } | Error::Precondition { .. }) => Ok(false),
            // A server that knows no conditions. Equal names mean equal artefacts, so that replacing one does no harm.
            Err(Error::NotImplemented { .. } | Error::NotSupported { .. }) => {
                let new = self.get(name)?.is_none();
                if new {
                    self.put(name, bytes)?;
                }
                Ok(new)
            }
            Err(error) => Err(self.failed(name)(error)),
        }
    }

    fn remove(&self, name: &str) -> Result<(), DepotError> {
        let path = self.path(name);
        unless_gone(self.runtime.block_on(self.objects.delete(&path))).map_err(self.failed(name))
    }

    fn remove_all(&self, folder: &str) -> Result<(), DepotError> {
        let path = self.path(folder);
        let removed = self.runtime.block_on(async {
            let mut removals = JoinSet::new();
            for object in self.objects.list_with_delimiter(Some(&path)).await?.objects {
                let objects = self.objects.clone();
                removals.spawn(async move { unless_gone(objects.delete(&object.location).await) });
            }
            removals.join_all().await.into_iter().collect::<Result<(), Error>>()
        });
        removed.map_err(self.failed(folder))
    }

    fn names(&self, folder: &str) -> Result<Vec<String>, DepotError> {
        let path = self.path(folder);
        let listed = self.runtime.block_on(self.objects.list_with_delimiter(Some(&path)));
        let objects = listed.map_err(self.failed(folder))?.objects;
        let mut names: Vec<String> =
            objects.iter().filter_map(|object| object.location.filename().map(str::to_owned)).collect();
        names.sort();
        Ok(names)
    }
}
