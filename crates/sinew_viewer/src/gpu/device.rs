//! A device that draws, or the line that says what is missing.

use std::future::Future;
use std::pin::pin;
use std::task::{Context, Poll, Waker};

/// A device that draws, with the queue of its work.
#[derive(Clone, Debug)]
pub struct Gpu {
    pub(crate) adapter: wgpu::Adapter,
    pub(crate) device: wgpu::Device,
    pub(crate) queue: wgpu::Queue,
}

/// Why nothing can be drawn by a graphics card. One line each.
#[derive(Debug, thiserror::Error)]
pub enum GpuError {
    /// There is no driver.
    #[error(
        "no driver for graphics ({0}): install one, on Debian `apt-get install mesa-vulkan-drivers libvulkan1`; \
         `sinew view SCENE --picture OUT.png` needs none"
    )]
    NoDriver(String),
    /// The driver cannot do what is needed.
    #[error("the driver '{name}' is not enough: {what}; `sinew view SCENE --picture OUT.png` needs none")]
    Driver {
        /// Its name.
        name: String,
        /// Reason.
        what: String,
    },
    /// There is no window system, or it refuses a window.
    #[error("no window can be opened: {0}; `sinew view SCENE --picture OUT.png` needs none")]
    NoWindow(String),
    /// A picture did not come back from the card.
    #[error("the picture did not come back from the card: {0}")]
    Lost(String),
}

impl Gpu {
    /// A device for pictures without a window.
    ///
    /// # Errors
    /// If there is no driver, or it cannot do what is needed.
    pub fn open() -> Result<Self, GpuError> {
        Self::open_for(&instance(), None)
    }

    /// A device for a window's surface.
    pub(crate) fn open_for(
        instance: &wgpu::Instance,
        surface: Option<&wgpu::Surface<'_>>,
    ) -> Result<Self, GpuError> {
        let options = wgpu::RequestAdapterOptions { compatible_surface: surface, ..Default::default() };
        let adapter = wait(instance.request_adapter(&options));
        let adapter = adapter.map_err(|error| GpuError::NoDriver(one_line(&error)))?;
        let name = adapter.get_info().name;
        let limits = wgpu::Limits::downlevel_defaults().using_resolution(adapter.limits());
        let limits = wgpu::Limits {
            max_storage_buffer_binding_size: adapter.limits().max_storage_buffer_binding_size,
            max_buffer_size: adapter.limits().max_buffer_size,
            ..limits
        };
        let descriptor = wgpu::DeviceDescriptor { required_limits: limits, ..Default::default() };
        let device = wait(adapter.request_device(&descriptor));
        let (device, queue) = device.map_err(|error| GpuError::Driver { name, what: one_line(&error) })?;
        Ok(Self { adapter, device, queue })
    }

    /// Name of the card and kind of its driver.
    pub fn name(&self) -> String {
        let info = self.adapter.get_info();
        format!("{} ({})", info.name, info.backend)
    }
}

/// Instance for pictures without a window.
fn instance() -> wgpu::Instance {
    wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env())
}

fn one_line(error: &dyn std::fmt::Display) -> String {
    error.to_string().lines().map(str::trim).collect::<Vec<_>>().join(" ")
}

/// Result of work that the driver does at once: on the desktop nothing that is waited for here sleeps.
fn wait<T>(work: impl Future<Output = T>) -> T {
    let mut work = pin!(work);
    let mut context = Context::from_waker(Waker::noop());
    loop {
        if let Poll::Ready(result) = work.as_mut().poll(&mut context) {
            return result;
        }
        std::thread::yield_now();
    }
}
