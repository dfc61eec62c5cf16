//! The numbers of random streams, in one registry.
//!
//! A stream is picked by [`hash(seed, number)`](super::sampling::hash). Numbers are listed by the seed that they belong to; where a
//! line says so, an index is added. Seeds whose streams are nothing but the indices of nodes, cells, pieces or draws need no number
//! here.

// Of the seed of a solve.
/// Points of the pilot that chooses a solver.
pub(crate) const PILOT_POINTS: u64 = 0x9107;
/// Points and replicates of the error estimate.
pub(crate) const ERROR: u64 = u64::MAX;
/// Cell radiosities; add 0 for those of values, 1 and 2 for those of replicates, 3 and 4 for those of the pilot.
pub(crate) const CELL_RADIOSITIES: u64 = 0x5e50_17ed;
/// Values taken again, to tell their noise.
pub(crate) const VALUES_AGAIN: u64 = 1;
/// Particles that tell what light meets.
pub(crate) const PARTICLES: u64 = 0x9a97;
/// Control points of the irradiance cache; add the number of the point.
pub(crate) const CACHE_CONTROLS: u64 = 0xc0 << 32;
/// Points by which the exposed part of a node is sampled; add the node.
pub(crate) const EXPOSURE: u64 = 1 << 40;

/// Of the seed of a solve: a pair of nodes, by their numbers.
pub(crate) fn pair(receiver: u32, source: u32) -> u64 {
    u64::from(receiver) << 32 | u64::from(source)
}

// Of the seed of a pair.
/// The samples that give a link its value; those that decide about it take the seed itself.
pub(crate) const LINK_VALUE: u64 = 1;

// Of the seed of cell radiosities, beside the numbers of the cells themselves.
/// View points of all cells.
pub(crate) const VIEW_POINTS: u64 = 0x5907;
/// Directions from the positions of a surface; add the surface.
pub(crate) const POSITION_DIRECTIONS: u64 = 0xd1;

// Of the seed of particles.
/// Where particles start; add the number.
pub(crate) const EMISSION: u64 = 1 << 32;
/// A bounce of all particles; add its number.
pub(crate) const PARTICLE_BOUNCES: u64 = 2 << 32;
/// Of the seed of a bounce: whether a particle goes on; add its number.
pub(crate) const PARTICLE_SURVIVAL: u64 = 1 << 32;

// Of the seed of a place.
/// Where the systematic sampling of emitters starts.
pub(crate) const EMITTERS: u64 = 5;
/// Draws of cells of reflectors.
pub(crate) const REFLECTORS: u64 = 6;
/// A record of the irradiance cache; add 0 or 1 for its gathers, 2 for what is near.
pub(crate) const RECORD: u64 = 10;
/// A view point of the cell; add its number.
pub(crate) const VIEW_POINT: u64 = 0x90;
/// Gathers at a control point of the irradiance cache; add 0 or 1.
pub(crate) const CONTROL_GATHERS: u64 = 100;
/// Paths that go on from where their first ray arrives; add the ray.
pub(crate) const PATHS_ONWARD: u64 = 1 << 32;
/// The next bounce of a path.
pub(crate) const NEXT_BOUNCE: u64 = 1 << 33;
/// The gather at a point of a reflector that was seen; add its number among those seen.
pub(crate) const ON_REFLECTORS: u64 = 1 << 34;
/// Rays of the pilot of replicates; add the ray.
pub(crate) const REPLICATE_PILOT: u64 = 1 << 40;

/// Of the seed of a place: a replicate, number 0 or 1, that has taken so many rays before.
pub(crate) fn replicate(number: u64, rays: u32) -> u64 {
    (u64::from(rays) << 8) | (10 + number)
}

/// Of the seed of a place: a piece of an emitter.
pub(crate) fn emitter_piece(emitter: u32, piece: usize) -> u64 {
    u64::from(emitter) << 32 | piece as u64
}

// Of either half of the seed of a shifted Sobol sequence.
/// The bits by which one coordinate is shifted.
pub(crate) const SOBOL_SHIFT: u64 = 7;

// Of a single draw.
/// The second coordinate of a point whose first is drawn by the seed itself, or any other second number.
pub(crate) const SECOND: u64 = 1;
/// A third number.
pub(crate) const THIRD: u64 = 2;
