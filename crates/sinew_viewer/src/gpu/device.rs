//! A graphics device, or the reason why there is none, in one line.

/// A graphics device with its queue.
#[derive(Clone, Debug)]
pub struct Gpu {
    pub(crate) adapter: wgpu::Adapter,
    pub(crate) device: wgpu::Device,
    pub(crate) queue: wgpu::Queue,
}

/// Reason why the graphics card cannot draw, in one line.
#[derive(Debug, thiserror::Error)]
pub enum GpuError {
    /// There is no driver.
    #[error(
        "no driver for graphics ({0}): install one, on Debian `apt-get install mesa-vulkan-drivers libvulkan1`; \
         `sinew view SCENE --picture OUT.png` needs none"
    )]
    NoDriver(String),
    /// The driver lacks a needed feature.
    #[error("the driver '{name}' is not enough: {what}; `sinew view SCENE --picture OUT.png` needs none")]
    Driver {
        /// Name of the device.
        name: String,
        /// Reason.
        what: String,
    },
    /// There is no window system, or the window system refuses a window.
    #[error("no window can be opened: {0}; `sinew view SCENE --picture OUT.png` needs none")]
    NoWindow(String),
    /// The card did not return a picture.
    #[error("the picture did not come back from the card: {0}")]
    Lost(String),
}

impl Gpu {
    /// Opens a device for pictures without a window; pages have none.
    ///
    /// # Errors
    /// If there is no driver, or it lacks a needed feature.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn open() -> Result<Self, GpuError> {
        let descriptor = wgpu::InstanceDescriptor::new_without_display_handle_from_env();
        wait(Self::open_for(&wgpu::Instance::new(descriptor), None))
    }

    /// Opens a device for a window's surface.
    pub(crate) async fn open_for(
        instance: &wgpu::Instance,
        surface: Option<&wgpu::Surface<'_>>,
    ) -> Result<Self, GpuError> {
        let options = wgpu::RequestAdapterOptions { compatible_surface: surface, ..Default::default() };
        let adapter = instance.request_adapter(&options).await;
        let adapter = adapter.map_err(|error| GpuError::NoDriver(one_line(&error)))?;
        let name = adapter.get_info().name;
        // Uses only WebGL2's limits, so that a page draws the same as a window.
        let limits = wgpu::Limits::downlevel_webgl2_defaults().using_resolution(adapter.limits());
        let limits = wgpu::Limits { max_buffer_size: adapter.limits().max_buffer_size, ..limits };
        let descriptor = wgpu::DeviceDescriptor { required_limits: limits, ..Default::default() };
        let device = adapter.request_device(&descriptor).await;
        let (device, queue) = device.map_err(|error| GpuError::Driver { name, what: one_line(&error) })?;
        Ok(Self { adapter, device, queue })
    }

    /// Returns the name of the card and the kind of its driver.
    pub fn name(&self) -> String {
        let info = self.adapter.get_info();
        format!("{} ({})", info.name, info.backend)
    }
}

fn one_line(error: &dyn std::fmt::Display) -> String {
    error.to_string().lines().map(str::trim).collect::<Vec<_>>().join(" ")
}

/// Returns the result of work that the driver completes without delay: on the desktop, none of the awaited
/// calls suspends.
#[cfg(not(target_arch = "wasm32"))]
pub(crate) fn wait<T>(work: impl Future<Output = T>) -> T {
    use std::task::{Context, Poll, Waker};
    let mut work = std::pin::pin!(work);
    let mut context = Context::from_waker(Waker::noop());
    loop {
        if let Poll::Ready(result) = work.as_mut().poll(&mut context) {
            return result;
        }
        std::thread::yield_now();
    }
}
