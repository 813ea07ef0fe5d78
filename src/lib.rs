//! A Whitted-style recursive ray tracer whose answers are right at every scale.
//!
//! # The path of a ray
//!
//! [`render::render`] calls [`render::render_blocks`], which cuts the picture into [blocks](render::blocks) and renders
//! each by itself. In a block, [`aa::AntiAliasing`] says which places on the film are asked for their colour, and a
//! [`render::Sampler`] (for a scene the `Worker` of its module) answers for many of them at once:
//! [`camera::View::direction`] turns each place into the direction of a camera ray, and `trace` of [`trace::Tracer`]
//! follows these rays together.
//!
//! [`accel::Accel`] finds the primitive that each ray meets first: boxes in single precision, made a little too large,
//! rule out most of them, and the [`geometry::Shape`]s that are left are asked in double precision. The
//! [`geometry::Surface`] that is hit (point, normal, error bound) and its [`material::Material`], coloured by a
//! [`texture::Texture`], say how light leaves it. Rays towards every [`light::Light`] ask what stands between, and
//! reflected and refracted rays, each knowing the surface it leaves, join the tracer's work list.
//!
//! What comes back is an [`aa::Sample`]. The samples of a pixel are averaged in linear light, the finished
//! [`render::Block`] is put on the film ([`film::Film::put`]), and the film is encoded at the very end. A
//! [`checkpoint`] keeps the finished blocks of a render that is stopped.
//!
//! A [`scene::Scene`] is made from [`scene::Parts`]: those of a [`scene::SceneDesc`], which is plain data read from TOML, of
//! an NFF file or of a model.
//!
//! # A picture
//!
//! ```
//! use whitted::{film, render, scene};
//!
//! let scene = scene::load_builtin("assignment")?;
//! let options = render::RenderOptions { size: Some([60, 60]), ..Default::default() };
//! let rendering = render::render(&scene, &options, &|_| ())?;
//!
//! let mut png = Vec::new();
//! film::write_png(&rendering.film, None, &mut png)?;
//! assert!(rendering.rays.camera > 60 * 60 && rendering.estimated_rmse.is_some_and(|rmse| rmse < 4.0));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Step by step
//!
//! Each step can be taken alone, with rays of any length and scale:
//!
//! ```
//! use glam::DVec3;
//! use whitted::{
//!     geometry::{Ray, Shape, Sphere, reflect, refract},
//! };
//!
//! // One primitive, number 0: a ball of glass, a light-year away from the origin in metres.
//! let center = DVec3::new(0.0, 0.0, -9.5e15);
//! let ball = Shape::from(Sphere::try_new(center, 4.0)?);
//! let ray = Ray::new(DVec3::new(2.0, 0.0, center.z + 16.0), DVec3::NEG_Z * 1e-100);
//! let (hit, surface) = ball.first_hit(0, &ray).expect("aimed at it");
//! assert_eq!(hit.face, 0);
//! assert!(surface.normal.dot(ray.dir) < 0.0);
//!
//! // Into the glass: refract a unit direction, leave the hit to the inside, and meet the far side.
//! let inside = refract(DVec3::NEG_Z, surface.normal, 1.0, 1.5).expect("no total reflection from outside");
//! let (far, far_surface) = ball.first_hit(0, &surface.leave(&hit, inside, true)).expect("the far side");
//! assert!(far.t > 4.0 && far.t < 8.0);
//!
//! // Out again: the direction leaves the sphere for good.
//! let out = refract(inside, -far_surface.normal, 1.5, 1.0).expect("it came in, so it gets out");
//! assert!(ball.first_hit(0, &far_surface.leave(&far, out, false)).is_none());
//!
//! // Total reflection is an answer, not an error.
//! let grazing = DVec3::new(0.9, 0.0, -0.19_f64.sqrt());
//! assert!(refract(grazing, DVec3::Z, 1.5, 1.0).is_none());
//! assert_eq!(reflect(grazing, DVec3::Z), DVec3::new(0.9, 0.0, 0.19_f64.sqrt()));
//!
//! // A whole scene: the nearest hit, and whether anything stands between.
//! let scene = whitted::scene::load_builtin("assignment")?;
//! let (hit, surface) = scene.nearest(&Ray::new(DVec3::ZERO, DVec3::NEG_Z)).expect("the wall");
//! assert_eq!((hit.primitive, surface.point.z), (1, -200.0));
//! let to_light = surface.leave(&hit, DVec3::new(30.0, 40.0, -10.0) - surface.point, false);
//! assert!(!scene.is_occluded(&to_light, 1.0));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod aa;
pub mod accel;
pub mod camera;
pub mod checkpoint;
pub mod classic;
pub mod color;
mod decode;
pub mod film;
pub mod geometry;
pub mod light;
pub mod material;
pub mod math;
pub mod render;
pub mod scene;
#[cfg(feature = "cli")]
pub mod study;
pub mod texture;
pub mod trace;

pub use color::Rgb;
