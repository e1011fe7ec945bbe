//! Embree as a shared library that is found at run time, versions 3 and 4, as a safe interface.
//!
//! Layouts and constants are those of `embree3/rtcore_*.h` (3.13) and `embree4/rtcore_*.h` (4.4).
//! This is the only file with unsafe code.
#![expect(unsafe_code, reason = "a C library is called")]

use std::ffi::{CString, c_char, c_int, c_uint, c_void};
use std::fmt;
use std::path::Path;
use std::ptr::null_mut;
use std::sync::atomic::{AtomicIsize, Ordering};

use libloading::Library;

/// The id of no triangle.
pub const NOTHING: u32 = u32::MAX;

/// `N` rays with what they met: `RTCRayHitN`, whose hits have room for the instance ids of every
/// version at the end.
#[repr(C, align(64))]
#[derive(Clone, Debug)]
pub struct Packet<const N: usize> {
    /// Origins, by axis.
    pub origin: [[f32; N]; 3],
    near: [f32; N],
    /// Directions, by axis.
    pub direction: [[f32; N]; 3],
    time: [f32; N],
    /// Where the rays end; after a search where they met something, after a test for occlusion
    /// negative if they did.
    pub far: [f32; N],
    mask: [u32; N],
    id: [u32; N],
    flags: [u32; N],
    normal: [[f32; N]; 3],
    uv: [[f32; N]; 2],
    /// The triangles met.
    pub triangle: [u32; N],
    geometry: [u32; N],
    instance: [[u32; N]; 4],
}

impl<const N: usize> Packet<N> {
    /// Rays without a direction, that have met nothing.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            origin: [[0.0; N]; 3],
            near: [0.0; N],
            direction: [[0.0; N]; 3],
            time: [0.0; N],
            far: [0.0; N],
            mask: [u32::MAX; N],
            id: [0; N],
            flags: [0; N],
            normal: [[0.0; N]; 3],
            uv: [[0.0; N]; 2],
            triangle: [NOTHING; N],
            geometry: [NOTHING; N],
            instance: [[NOTHING; N]; 4],
        }
    }

    /// Forgets what was met; ends are to be set anew.
    #[inline]
    pub const fn forget(&mut self) {
        // The geometry is what tells a hit from a miss; Embree sets the rest when there is one.
        self.triangle = [NOTHING; N];
        self.geometry = [NOTHING; N];
        self.instance[0] = [NOTHING; N];
    }
}

impl<const N: usize> Default for Packet<N> {
    fn default() -> Self {
        Self::new()
    }
}

/// Which rays of a packet are there: -1 or 0.
#[repr(C, align(64))]
#[derive(Clone, Copy, Debug)]
pub struct Valid<const N: usize>(pub [c_int; N]);

/// `RTCIntersectContext` of Embree 3, with room to spare.
#[repr(C)]
struct Context {
    flags: c_uint,
    filter: *mut c_void,
    instance: [c_uint; 8],
}

/// `RTCIntersectArguments` and `RTCOccludedArguments` of Embree 4.
#[repr(C)]
struct Arguments {
    flags: c_uint,
    features: c_uint,
    context: *mut c_void,
    filter: *mut c_void,
    intersect: *mut c_void,
    width: f32,
}

type Handle = *mut c_void;
/// `(scene, context, rays)` in version 3, `(scene, rays, arguments)` in version 4.
type Single = unsafe extern "C" fn(Handle, *mut c_void, *mut c_void);
/// The same behind which rays are valid.
type Many = unsafe extern "C" fn(*const c_int, Handle, *mut c_void, *mut c_void);
type Monitor = unsafe extern "C" fn(*mut c_void, isize, bool) -> bool;

/// Declares the functions that are called, and looks them up.
macro_rules! functions {
    ($($field:ident = $symbol:literal: fn($($argument:ty),*) $(-> $result:ty)?;)*) => {
        #[derive(Clone, Copy)]
        struct Functions {
            $($field: unsafe extern "C" fn($($argument),*) $(-> $result)?,)*
            intersect: (Single, [Many; 2]),
            occluded: (Single, [Many; 2]),
        }

        impl Functions {
            fn find(library: &Library) -> Result<Self, libloading::Error> {
                // SAFETY: the types are those of the headers of versions 3 and 4, and the library
                // is never closed, so the addresses stay good.
                unsafe {
                    Ok(Self {
                        $($field: *library.get($symbol)?,)*
                        intersect: (*library.get(b"rtcIntersect1\0")?, [
                            *library.get(b"rtcIntersect8\0")?,
                            *library.get(b"rtcIntersect16\0")?,
                        ]),
                        occluded: (*library.get(b"rtcOccluded1\0")?, [
                            *library.get(b"rtcOccluded8\0")?,
                            *library.get(b"rtcOccluded16\0")?,
                        ]),
                    })
                }
            }
        }
    };
}

functions! {
    new_device = b"rtcNewDevice\0": fn(*const c_char) -> Handle;
    release_device = b"rtcReleaseDevice\0": fn(Handle);
    device_error = b"rtcGetDeviceError\0": fn(Handle) -> c_int;
    device_property = b"rtcGetDeviceProperty\0": fn(Handle, c_int) -> isize;
    monitor = b"rtcSetDeviceMemoryMonitorFunction\0": fn(Handle, Monitor, *mut c_void);
    new_scene = b"rtcNewScene\0": fn(Handle) -> Handle;
    release_scene = b"rtcReleaseScene\0": fn(Handle);
    scene_quality = b"rtcSetSceneBuildQuality\0": fn(Handle, c_int);
    commit_scene = b"rtcCommitScene\0": fn(Handle);
    new_geometry = b"rtcNewGeometry\0": fn(Handle, c_int) -> Handle;
    release_geometry = b"rtcReleaseGeometry\0": fn(Handle);
    geometry_quality = b"rtcSetGeometryBuildQuality\0": fn(Handle, c_int);
    commit_geometry = b"rtcCommitGeometry\0": fn(Handle);
    new_buffer = b"rtcSetNewGeometryBuffer\0":
        fn(Handle, c_int, c_uint, c_int, usize, usize) -> *mut c_void;
    attach = b"rtcAttachGeometry\0": fn(Handle, Handle) -> c_uint;
}

/// Bytes that a device holds, and the most it did.
#[derive(Debug, Default)]
struct Memory {
    now: AtomicIsize,
    most: AtomicIsize,
}

/// A loaded Embree with a device.
pub struct Embree {
    functions: Functions,
    device: Handle,
    /// Lives as long as the device, which reports to it.
    memory: Box<Memory>,
    version: [isize; 3],
}

impl fmt::Debug for Embree {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Embree")
            .field("version", &self.version)
            .finish_non_exhaustive()
    }
}

unsafe extern "C" fn count(memory: *mut c_void, bytes: isize, _post: bool) -> bool {
    // SAFETY: it is the `Memory` that was registered with this function, and it outlives the device.
    let memory = unsafe { &*memory.cast::<Memory>() };
    let now = memory.now.fetch_add(bytes, Ordering::Relaxed) + bytes;
    memory.most.fetch_max(now, Ordering::Relaxed);
    true
}

impl Embree {
    /// Loads a library and makes a device that builds with so many threads.
    ///
    /// # Errors
    /// In words: there is no such library, or it is no Embree 3 or 4.
    pub fn open(path: &Path, threads: usize) -> Result<Self, String> {
        // SAFETY: what Embree and TBB do when they are loaded asks nothing of the caller.
        let library = unsafe { Library::new(path) }.map_err(|error| error.to_string())?;
        let functions = Functions::find(&library).map_err(|error| error.to_string())?;
        // The worker threads of TBB cannot be stopped in time for the library to go away.
        std::mem::forget(library);
        let config = CString::new(format!("threads={threads}")).map_err(|e| e.to_string())?;
        // SAFETY: the text ends in a zero byte.
        let device = unsafe { (functions.new_device)(config.as_ptr()) };
        if device.is_null() {
            return Err("it makes no device on this processor".to_owned());
        }
        let memory = Box::<Memory>::default();
        // SAFETY: the device is one; the memory is behind a box that lives longer than it.
        unsafe {
            let address = std::ptr::from_ref::<Memory>(&memory).cast_mut();
            (functions.monitor)(device, count, address.cast());
        }
        // SAFETY: the device is one, and these properties exist in both versions.
        let version = [1, 2, 3].map(|which| unsafe { (functions.device_property)(device, which) });
        let embree = Self {
            functions,
            device,
            memory,
            version,
        };
        if matches!(version[0], 3 | 4) {
            Ok(embree)
        } else {
            Err(format!("it is Embree {}, not 3 or 4", embree.version()))
        }
    }

    /// The version as text: `3.13.5`.
    #[must_use]
    pub fn version(&self) -> String {
        self.version.map(|number| number.to_string()).join(".")
    }

    /// The first number of the version.
    #[must_use]
    pub const fn major(&self) -> isize {
        self.version[0]
    }

    /// Whether packets of so many rays have code of their own on this processor.
    #[must_use]
    pub fn has_packets_of(&self, rays: usize) -> bool {
        let property = match rays {
            1 => return true,
            8 => 33,
            16 => 34,
            _ => return false,
        };
        // SAFETY: the device is one, and these properties exist in both versions.
        unsafe { (self.functions.device_property)(self.device, property) != 0 }
    }

    /// Bytes the device holds now, and the most it held since this was asked last.
    pub fn memory(&self) -> (isize, isize) {
        let now = self.memory.now.load(Ordering::Relaxed);
        (now, self.memory.most.swap(now, Ordering::Relaxed))
    }

    /// Gives the device triangles, in memory of its own.
    ///
    /// # Errors
    /// In words: the triangles are refused, or there is no memory for them.
    pub fn triangles(
        &self,
        positions: &[[f32; 3]],
        triangles: &[[u32; 3]],
        high_quality: bool,
    ) -> Result<EmbreeTriangles<'_>, String> {
        const TRIANGLES: c_int = 0;
        const INDICES: (c_int, c_int) = (0, 0x5003);
        const VERTICES: (c_int, c_int) = (1, 0x9003);
        const MEDIUM: c_int = 1;
        const HIGH: c_int = 2;
        if let Some(&index) = triangles.iter().flatten().max()
            && index as usize >= positions.len()
        {
            return Err(format!("there is no position {index}"));
        }
        let f = &self.functions;
        let quality = if high_quality { HIGH } else { MEDIUM };
        // SAFETY: handles are those that Embree returned, not released yet. Both buffers have as
        // many items of three 32-bit numbers as are copied; Embree itself keeps 16 bytes behind
        // the last vertex readable. Every index is in range.
        unsafe {
            let scene = EmbreeScene {
                embree: self,
                scene: (f.new_scene)(self.device),
            };
            (f.scene_quality)(scene.scene, quality);
            let geometry = (f.new_geometry)(self.device, TRIANGLES);
            (f.geometry_quality)(geometry, quality);
            let buffer =
                |(kind, format), items| (f.new_buffer)(geometry, kind, 0, format, 12, items);
            let vertices = buffer(VERTICES, positions.len()).cast::<[f32; 3]>();
            let indices = buffer(INDICES, triangles.len()).cast::<[u32; 3]>();
            let filled = !(vertices.is_null() || indices.is_null());
            if filled {
                vertices.copy_from_nonoverlapping(positions.as_ptr(), positions.len());
                indices.copy_from_nonoverlapping(triangles.as_ptr(), triangles.len());
                (f.commit_geometry)(geometry);
                (f.attach)(scene.scene, geometry);
            }
            (f.release_geometry)(geometry);
            self.check()?;
            if filled {
                Ok(EmbreeTriangles(scene))
            } else {
                Err("Embree gives no memory for the triangles".to_owned())
            }
        }
    }

    fn check(&self) -> Result<(), String> {
        // SAFETY: the device is one.
        match unsafe { (self.functions.device_error)(self.device) } {
            0 => Ok(()),
            code => Err(format!("Embree reports error {code}")),
        }
    }
}

impl Drop for Embree {
    fn drop(&mut self) {
        // SAFETY: the device is one; scenes borrow this, so none is left. What is freed now is still
        // counted, which the monitor's memory allows: it is dropped after this.
        unsafe { (self.functions.release_device)(self.device) };
    }
}

/// Triangles on a device, nothing built over them yet.
#[derive(Debug)]
pub struct EmbreeTriangles<'a>(EmbreeScene<'a>);

impl<'a> EmbreeTriangles<'a> {
    /// Builds the hierarchy.
    ///
    /// # Errors
    /// In words: there is no memory for it.
    pub fn build(self) -> Result<EmbreeScene<'a>, String> {
        let Self(scene) = self;
        // SAFETY: the scene is one, and only this thread has it.
        unsafe { (scene.embree.functions.commit_scene)(scene.scene) };
        scene.embree.check()?;
        Ok(scene)
    }
}

/// Triangles with their hierarchy.
#[derive(Debug)]
pub struct EmbreeScene<'a> {
    embree: &'a Embree,
    scene: Handle,
}

impl EmbreeScene<'_> {
    /// The first triangle on each valid ray.
    #[inline]
    pub fn closest<const N: usize>(&self, valid: &Valid<N>, rays: &mut Packet<N>, coherent: bool) {
        self.ask(&self.embree.functions.intersect, valid, rays, coherent);
    }

    /// Whether any triangle is on each valid ray.
    #[inline]
    pub fn occluded<const N: usize>(&self, valid: &Valid<N>, rays: &mut Packet<N>, coherent: bool) {
        self.ask(&self.embree.functions.occluded, valid, rays, coherent);
    }

    #[inline(always)]
    fn ask<const N: usize>(
        &self,
        (single, many): &(Single, [Many; 2]),
        valid: &Valid<N>,
        rays: &mut Packet<N>,
        coherent: bool,
    ) {
        let rays = std::ptr::from_mut(rays).cast::<c_void>();
        let (mut context, mut arguments);
        let (second, third) = if self.embree.version[0] == 3 {
            context = Context {
                flags: c_uint::from(coherent),
                filter: null_mut(),
                instance: [NOTHING; 8],
            };
            ((&raw mut context).cast(), rays)
        } else {
            arguments = Arguments {
                flags: c_uint::from(coherent) << 16,
                features: c_uint::MAX,
                context: null_mut(),
                filter: null_mut(),
                intersect: null_mut(),
                width: 0.0,
            };
            (rays, (&raw mut arguments).cast())
        };
        let many = match N {
            // SAFETY: the scene is built; a packet begins with the layout of `RTCRayHit`,
            // and so with that of `RTCRay`.
            1 => return unsafe { single(self.scene, second, third) },
            8 => many[0],
            16 => many[1],
            _ => return,
        };
        // SAFETY: the same of `RTCRayHitN` for this `N`; the marks are as many, and both are aligned
        // to more than the 64 bytes at most that are asked for.
        unsafe { many(valid.0.as_ptr(), self.scene, second, third) };
    }
}

impl Drop for EmbreeScene<'_> {
    fn drop(&mut self) {
        // SAFETY: the scene is one, released once, before its device.
        unsafe { (self.embree.functions.release_scene)(self.scene) };
    }
}
