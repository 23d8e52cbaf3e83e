//! Frames are compressed and written on a thread of their own, while the run goes on.

use std::collections::VecDeque;
use std::path::PathBuf;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use fractum_vtk::PendingFile;

use crate::atomic::Group;
use crate::error::WriteError;

/// Bytes of frames that may wait, with the one that is being compressed: small frames follow each other faster than a disk
/// takes them.
pub const WAITING: usize = 16 << 20;
/// Files that are brought to the disk together at most, so that few are open at a time.
const TOGETHER: usize = 64;
/// Frames that come within this time go to the disk together.
const COLLECTED: Duration = Duration::from_millis(100);

/// The files of a frame at their paths.
type Files = Vec<(PathBuf, PendingFile)>;

/// Frames that wait to be written.
#[derive(Debug, Default)]
struct Queue {
    frames: VecDeque<Files>,
    /// Bytes of those that wait, and of the one that is being compressed.
    size: usize,
    /// Whether a thread takes frames from here.
    is_served: bool,
    /// Whether no more frames come for now.
    is_closed: bool,
}

/// The queue, and the news that it has changed.
#[derive(Debug, Default)]
struct Shared {
    queue: Mutex<Queue>,
    changed: Condvar,
}

fn size_of(frame: &Files) -> usize {
    frame.iter().map(|(_, file)| file.size()).sum()
}

impl Shared {
    fn queue(&self) -> MutexGuard<'_, Queue> {
        // A thread that panicked is told of where it is joined.
        self.queue.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Adds a frame once there is room for it; whether somebody takes it from there.
    fn push(&self, frame: Files) -> bool {
        let size = size_of(&frame);
        let full = |queue: &mut Queue| queue.is_served && queue.size > 0 && queue.size + size > WAITING;
        let mut queue = self.changed.wait_while(self.queue(), full).unwrap_or_else(PoisonError::into_inner);
        queue.frames.push_back(frame);
        queue.size += size;
        queue.is_closed = false;
        self.changed.notify_all();
        std::mem::replace(&mut queue.is_served, true)
    }

    /// No more frames come: what has been collected goes to the disk now.
    fn close(&self) {
        self.queue().is_closed = true;
        self.changed.notify_all();
    }

    /// The next frame; none, and nobody who takes frames, once the queue is empty.
    fn take(&self) -> Option<Files> {
        let mut queue = self.queue();
        let frame = queue.frames.pop_front();
        queue.is_served = frame.is_some();
        frame
    }

    /// The next frame that comes until then.
    fn take_until(&self, end: Instant) -> Option<Files> {
        let none_yet = |queue: &mut Queue| queue.frames.is_empty() && !queue.is_closed;
        let left = end.saturating_duration_since(Instant::now());
        let waited = self.changed.wait_timeout_while(self.queue(), left, none_yet);
        waited.unwrap_or_else(PoisonError::into_inner).0.frames.pop_front()
    }

    /// Compresses a frame and gives its room to others.
    fn add(&self, frame: Files, group: &mut Group) {
        let size = size_of(&frame);
        frame.into_iter().for_each(|(path, file)| group.add(&path, &file.bytes()));
        self.queue().size -= size;
        self.changed.notify_all();
    }

    /// Writes frame after frame until none waits; after an error those that wait are given up.
    fn serve(&self) -> Result<(), WriteError> {
        let _end = EndOfService(self);
        let written = self.write_all();
        if written.is_err() {
            self.give_up();
        }
        written
    }

    fn give_up(&self) {
        *self.queue() = Queue::default();
        self.changed.notify_all();
    }

    fn write_all(&self) -> Result<(), WriteError> {
        while let Some(first) = self.take() {
            let (mut group, end) = (Group::default(), Instant::now() + COLLECTED);
            let mut next = Some(first);
            while let Some(frame) = next {
                self.add(frame, &mut group);
                next = if group.len() < TOGETHER { self.take_until(end) } else { None };
            }
            group.finish()?;
        }
        Ok(())
    }
}

/// Whoever waits for room in the queue must not wait for a thread that has panicked.
struct EndOfService<'a>(&'a Shared);

impl Drop for EndOfService<'_> {
    fn drop(&mut self) {
        if thread::panicking() {
            self.0.give_up();
        }
    }
}

/// Writes frame after frame on a thread of its own, in their order.
#[derive(Debug, Default)]
pub struct FrameWriter {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<Result<(), WriteError>>>,
}

impl FrameWriter {
    /// Begins to write the files of a frame at their paths, one after the other, behind the frames before; waits only where too
    /// many of those are not written yet.
    ///
    /// # Errors
    /// [`WriteError`] of a frame before; of this one where there is no thread for it.
    pub fn begin(&mut self, frame: Vec<(PathBuf, PendingFile)>) -> Result<(), WriteError> {
        self.check()?;
        if self.shared.push(frame) {
            return Ok(());
        }
        // The thread before has seen an empty queue, or failed.
        if let Err(error) = self.join() {
            self.shared.give_up();
            return Err(error);
        }
        let shared = Arc::clone(&self.shared);
        match thread::Builder::new().name("frames".into()).spawn(move || shared.serve()) {
            Ok(thread) => self.thread = Some(thread),
            // A system without a thread to spare: the run waits for its frame.
            Err(_) => {
                self.shared.close();
                self.shared.serve()?;
            }
        }
        Ok(())
    }

    /// The error of the frames so far, if there has been one by now.
    ///
    /// # Errors
    /// [`WriteError`], once.
    pub fn check(&mut self) -> Result<(), WriteError> {
        if self.thread.as_ref().is_some_and(JoinHandle::is_finished) { self.join() } else { Ok(()) }
    }

    /// Waits for the last frame.
    ///
    /// # Errors
    /// [`WriteError`] of that frame or one before.
    pub fn finish(&mut self) -> Result<(), WriteError> {
        self.shared.close();
        self.join()
    }

    fn join(&mut self) -> Result<(), WriteError> {
        let Some(thread) = self.thread.take() else { return Ok(()) };
        // A panic there is one here.
        thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    }
}

impl Drop for FrameWriter {
    /// A frame that was begun is written, also where the run ends by an error, which is the one to report.
    fn drop(&mut self) {
        self.shared.close();
        let _ = self.thread.take().map(JoinHandle::join);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fractum_vtk::{Collection, Compression, Field, PolyCells, PolyData};
    use std::fs;
    use std::path::Path;

    fn cloud(points: &[[f64; 3]], path: &Path) -> ((PathBuf, PendingFile), Vec<u8>) {
        let data = PolyData {
            points,
            cells: PolyCells::Points,
            point_data: &[Field::vector("velocity", points)],
            cell_data: &[],
            time: Some(0.5),
        };
        ((path.to_owned(), data.pending(Compression::Fast).unwrap()), data.to_bytes(Compression::Fast).unwrap())
    }

    #[test]
    fn frames_written_beside_the_run_are_those_of_their_instants() {
        let folder = tempfile::tempdir().unwrap();
        let mut writer = FrameWriter::default();
        let mut points: Vec<[f64; 3]> = (0..30_000).map(|i| [f64::from(i).sin(), f64::from(i).cos(), 1.0]).collect();
        let mut expected = Vec::new();
        for frame in 0..4 {
            let path = folder.path().join(format!("{frame}.vtp"));
            let (pending, bytes) = cloud(&points, &path);
            let mut collection = Collection::default();
            collection.push(0.5, 0, "cloud", format!("{frame}.vtp"));
            writer.begin(vec![pending, (folder.path().join("fields.pvd"), collection.pending())]).unwrap();
            points.iter_mut().for_each(|point| point[2] += 1.0);
            expected.push((path, bytes));
        }
        writer.finish().unwrap();
        assert!(expected.iter().all(|(path, bytes)| fs::read(path).unwrap() == *bytes));
        assert!(fs::read_to_string(folder.path().join("fields.pvd")).unwrap().contains("file=\"3.vtp\""));
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 5);
    }

    #[test]
    fn a_frame_that_fails_is_told_once_and_those_after_it_are_not_begun() {
        let folder = tempfile::tempdir().unwrap();
        let [bad, good] = ["absent/a.vtp", "b.vtp"].map(|name| folder.path().join(name));
        let mut writer = FrameWriter::default();
        writer.begin(vec![cloud(&[[0.0; 3]], &bad).0, cloud(&[[0.0; 3]], &good).0]).unwrap();
        // The second frame comes before or after the first has failed.
        let error = writer.begin(vec![cloud(&[[0.0; 3]], &good).0]).and_then(|()| writer.finish()).unwrap_err();
        assert!(matches!(error, WriteError::MissingFolder { .. }), "{error}");
        assert!(!good.exists());
        writer.check().unwrap();
        writer.finish().unwrap();
    }

    #[test]
    fn more_frames_than_may_wait_are_all_written() {
        let folder = tempfile::tempdir().unwrap();
        let mut writer = FrameWriter::default();
        let points: Vec<[f64; 3]> = (0..60_000).map(|i| [f64::from(i), 0.0, 1.0]).collect();
        for frame in 0..12 {
            let path = folder.path().join(format!("{frame}.vtp"));
            let (pending, _) = cloud(&points, &path);
            assert!(12 * pending.1.size() > 2 * WAITING);
            writer.begin(vec![pending]).unwrap();
            assert!(writer.shared.queue().size <= WAITING);
        }
        writer.finish().unwrap();
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 12);
    }
}
