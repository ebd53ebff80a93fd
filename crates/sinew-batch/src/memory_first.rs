//! Files in memory while they are few bytes, then on the disk.
//!
//! For results that are copied to where they stay: a hundred small files in forty folders cost the system more time than what they hold.

use sinew_results::{Disk, Storage, StoredFile};
use std::collections::BTreeMap;
use std::fs;
use std::io::{self, Cursor, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// A storage that fills memory before the disk.
#[derive(Debug, Default)]
pub(super) struct MemoryFirst {
    files: Mutex<BTreeMap<PathBuf, Arc<Mutex<Content>>>>,
    room: Arc<Room>,
}

/// Bytes that are held in memory, of how many.
#[derive(Debug, Default)]
struct Room {
    held: AtomicUsize,
    most: usize,
}

/// What a file holds.
#[derive(Debug)]
struct Content {
    path: PathBuf,
    place: ContentPlace,
    room: Arc<Room>,
}

#[derive(Debug)]
enum ContentPlace {
    Memory(Cursor<Vec<u8>>),
    Disk(fs::File),
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Content {
    /// Takes a file out of memory, at the place in it that is written next.
    fn move_to_disk(&mut self) -> io::Result<()> {
        let ContentPlace::Memory(content) = &self.place else { return Ok(()) };
        fs::create_dir_all(self.path.parent().unwrap_or(Path::new("")))?;
        let mut file = fs::File::options().read(true).write(true).create(true).truncate(true).open(&self.path)?;
        file.write_all(content.get_ref())?;
        file.seek(SeekFrom::Start(content.position()))?;
        self.forget();
        self.place = ContentPlace::Disk(file);
        Ok(())
    }

    /// Removes what another file replaces from the disk, where it would be taken for that.
    fn leave_disk(&self) -> io::Result<()> {
        if matches!(self.place, ContentPlace::Disk(_)) { Disk.remove(&self.path) } else { Ok(()) }
    }

    /// Gives back the room of what is in memory.
    fn forget(&mut self) {
        if let ContentPlace::Memory(content) = &mut self.place {
            self.room.held.fetch_sub(content.get_ref().len(), Ordering::Relaxed);
            *content = Cursor::default();
        }
    }
}

impl Drop for Content {
    fn drop(&mut self) {
        self.forget();
    }
}

impl Write for Content {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if let ContentPlace::Memory(content) = &mut self.place {
            if self.room.held.load(Ordering::Relaxed) + bytes.len() <= self.room.most {
                let before = content.get_ref().len();
                let written = content.write(bytes)?;
                self.room.held.fetch_add(content.get_ref().len() - before, Ordering::Relaxed);
                return Ok(written);
            }
            self.move_to_disk()?;
        }
        match &mut self.place {
            ContentPlace::Disk(file) => file.write(bytes),
            ContentPlace::Memory(content) => content.write(bytes),
        }
    }
    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// A file being written.
struct MemoryFile(Arc<Mutex<Content>>);

impl Write for MemoryFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        locked(&self.0).write(bytes)
    }
    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Seek for MemoryFile {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        match &mut locked(&self.0).place {
            ContentPlace::Memory(content) => content.seek(to),
            ContentPlace::Disk(file) => file.seek(to),
        }
    }
}

impl StoredFile for MemoryFile {
    fn sync(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl MemoryFirst {
    /// A storage that holds `most` bytes in memory.
    #[must_use]
    pub(super) fn new(most: usize) -> Self {
        Self { files: Mutex::default(), room: Arc::new(Room { held: AtomicUsize::new(0), most }) }
    }

    /// Paths of the files that are in memory, in order.
    #[must_use]
    pub(super) fn in_memory(&self) -> Vec<PathBuf> {
        let is_held = |content: &Mutex<Content>| matches!(locked(content).place, ContentPlace::Memory(_));
        locked(&self.files).iter().filter(|(_, content)| is_held(content)).map(|(path, _)| path.clone()).collect()
    }
}

impl Storage for MemoryFirst {
    fn create_folder(&self, path: &Path) -> io::Result<()> {
        Disk.create_folder(path)
    }

    fn create(&self, path: &Path) -> io::Result<Box<dyn StoredFile>> {
        let (path, place) = (path.to_owned(), ContentPlace::Memory(Cursor::default()));
        let content = Arc::new(Mutex::new(Content { path: path.clone(), place, room: Arc::clone(&self.room) }));
        if let Some(before) = locked(&self.files).insert(path, Arc::clone(&content)) {
            locked(&before).leave_disk()?;
        }
        Ok(Box::new(MemoryFile(content)))
    }

    /// Nothing that is stopped here is continued: only what is on the disk is opened.
    fn resume(&self, path: &Path, length: u64) -> io::Result<Box<dyn StoredFile>> {
        Disk.resume(path, length)
    }

    fn read(&self, path: &Path) -> io::Result<Box<dyn Read>> {
        if let Some(content) = locked(&self.files).get(path)
            && let ContentPlace::Memory(content) = &locked(content).place
        {
            return Ok(Box::new(Cursor::new(content.get_ref().clone())));
        }
        Disk.read(path)
    }

    fn exists(&self, path: &Path) -> bool {
        let is_held =
            locked(&self.files).range(path.to_owned()..).next().is_some_and(|(held, _)| held.starts_with(path));
        is_held || path.exists()
    }

    fn sync(&self, _: &Path) -> io::Result<()> {
        Ok(())
    }

    fn rename(&self, from: &Path, to: &Path) -> io::Result<()> {
        let mut files = locked(&self.files);
        let moved: Vec<PathBuf> = files.keys().filter(|path| path.starts_with(from)).cloned().collect();
        for path in moved {
            let Some(content) = files.remove(&path) else { continue };
            let inside = path.strip_prefix(from).unwrap_or(Path::new(""));
            let new = if inside.as_os_str().is_empty() { to.to_owned() } else { to.join(inside) };
            locked(&content).path.clone_from(&new);
            if let Some(before) = files.insert(new, content) {
                locked(&before).leave_disk()?;
            }
        }
        // Files of a folder may lie in both places.
        if from.exists() { Disk.rename(from, to) } else { Ok(()) }
    }

    fn remove(&self, path: &Path) -> io::Result<()> {
        locked(&self.files).retain(|held, _| !held.starts_with(path));
        Disk.remove(path)
    }

    fn files_below(&self, folder: &Path) -> io::Result<Vec<PathBuf>> {
        let mut files = self.in_memory();
        files.retain(|file| file.starts_with(folder));
        if folder.exists() {
            files.extend(Disk.files_below(folder)?);
        }
        Ok(files)
    }

    fn is_temporary(&self) -> bool {
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn write(storage: &MemoryFirst, path: &Path, bytes: &[u8]) -> Box<dyn StoredFile> {
        let mut file = storage.create(path).unwrap();
        file.write_all(bytes).unwrap();
        file
    }

    fn read(storage: &MemoryFirst, path: &Path) -> Vec<u8> {
        let mut bytes = vec![];
        storage.read(path).unwrap().read_to_end(&mut bytes).unwrap();
        bytes
    }

    #[test]
    fn files_are_read_from_memory_and_from_disk() {
        let root = tempfile::tempdir().unwrap();
        let path = |name: &str| root.path().join(name);
        let storage = MemoryFirst::new(10);
        let mut first = write(&storage, &path("a.partial"), b"12345678");
        assert!(!path("a.partial").exists());
        // The ninth to the eleventh byte find no room; what lies before goes with them.
        first.write_all(b"9ab").unwrap();
        assert_eq!(fs::read(path("a.partial")).unwrap(), b"123456789ab");
        first.seek(SeekFrom::Start(0)).unwrap();
        first.write_all(b"ABC").unwrap();
        storage.rename(&path("a.partial"), &path("a")).unwrap();
        assert_eq!(read(&storage, &path("a")), b"ABC456789ab");
        drop(write(&storage, &path("folder.partial/in/0"), b"xyz"));
        drop(write(&storage, &path("folder.partial/in/1"), b"0123456789"));
        storage.rename(&path("folder.partial"), &path("folder")).unwrap();
        assert_eq!(storage.in_memory(), [path("folder/in/0")]);
        assert_eq!([0, 1].map(|n| read(&storage, &path(&format!("folder/in/{n}"))).len()), [3, 10]);
        assert!(storage.exists(&path("folder")) && storage.exists(&path("folder/in/0")));
        storage.remove(&path("folder")).unwrap();
        assert!(!storage.exists(&path("folder")) && storage.in_memory().is_empty());
        // What was removed leaves its room.
        drop(write(&storage, &path("b"), b"0123456789"));
        assert_eq!(storage.in_memory(), [path("b")]);
        assert_eq!(storage.read(&path("c")).err().unwrap().kind(), io::ErrorKind::NotFound);
    }

    /// A file that went to the disk comes back into memory, once where it is created again and once where another gets its name.
    #[test]
    fn nothing_stays_on_the_disk_of_a_file_that_is_replaced() {
        let root = tempfile::tempdir().unwrap();
        let path = |name: &str| root.path().join(name);
        let storage = MemoryFirst::new(10);
        drop(write(&storage, &path("a"), b"longer than ten"));
        drop(write(&storage, &path("b"), b"longer than ten"));
        assert!(path("a").exists() && path("b").exists());
        drop(write(&storage, &path("a"), b"short"));
        drop(write(&storage, &path("b.partial"), b"new"));
        storage.rename(&path("b.partial"), &path("b")).unwrap();
        assert!(!path("a").exists() && !path("b").exists());
        assert_eq!([read(&storage, &path("a")), read(&storage, &path("b"))], [b"short".to_vec(), b"new".to_vec()]);
        assert_eq!(storage.in_memory(), [path("a"), path("b")]);
    }

    #[test]
    fn a_file_is_written_over_from_its_start_and_replaced() {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("a");
        let storage = MemoryFirst::new(100);
        let mut file = write(&storage, &path, b"0000 frames");
        file.seek(SeekFrom::Start(0)).unwrap();
        file.write_all(b"0123").unwrap();
        assert_eq!(read(&storage, &path), b"0123 frames");
        drop(write(&storage, &path, b"new"));
        assert_eq!(read(&storage, &path), b"new");
        assert!(!path.exists());
    }
}
