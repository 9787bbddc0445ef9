//! What both clients need to wait: threads and timers. The runtimes that offer more take long to compile.
use futures::{channel::oneshot, executor, future};
use std::{future::Future, pin::pin, thread, time::Duration};

/// Runs it in a thread of its own.
pub fn spawn<T>(future: impl Future<Output = T> + Send + 'static) {
    thread::spawn(move || {
        executor::block_on(future);
    });
}

pub async fn pause(time: Duration) {
    let (sender, receiver) = oneshot::channel();
    thread::spawn(move || {
        thread::sleep(time);
        let _ = sender.send(());
    });
    let _ = receiver.await;
}

pub async fn within<T>(seconds: u64, future: impl Future<Output = T>) -> Option<T> {
    match future::select(pin!(future), pin!(pause(Duration::from_secs(seconds)))).await {
        future::Either::Left((result, _)) => Some(result),
        future::Either::Right(_) => None,
    }
}
