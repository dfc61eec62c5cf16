//! The numbers of random streams, in one registry.
//!
//! A stream is picked by [`hash(seed, number)`](super::sampling::hash). Numbers are listed by the seed that they belong to; where a line
//! says so, an index is added. Those of one seed differ in their highest byte, so no index reaches another's; 0 there is left to seeds
//! whose streams are also picked by an index alone, of nodes, cells or draws.

/// The numbers of the kind `kind` of streams; indices below 2^56 may be added.
const fn kind(kind: u8) -> u64 {
    (kind as u64) << 56
}

// Of the seed of a solve.
/// Points of the pilot that chooses a solver.
pub(crate) const PILOT_POINTS: u64 = kind(1);
/// Points and replicates of the error estimate.
pub(crate) const ERROR: u64 = kind(2);
/// Cell radiosities; add 0 for those of values, and from 1 on for those of replicates, then of the pilot.
pub(crate) const CELL_RADIOSITIES: u64 = kind(3);
/// Values taken again, to tell their noise.
pub(crate) const VALUES_AGAIN: u64 = kind(4);
/// Particles that tell what light meets.
pub(crate) const PARTICLES: u64 = kind(5);
/// Control points of the irradiance cache; add the number of the point.
pub(crate) const CACHE_CONTROLS: u64 = kind(6);
/// Points by which the exposed part of a node is sampled; add the node.
pub(crate) const EXPOSURE: u64 = kind(7);
/// Pairs of nodes; add the receiver. Of what that gives, the source picks the stream.
pub(crate) const PAIRS: u64 = kind(8);
/// Points in elements of meshes; add the surface. Of what that gives, the round and the triangle pick the stream.
pub(crate) const MESH_TESTS: u64 = kind(9);
/// Points at which meshes are judged; add the round.
pub(crate) const MESH_JUDGED: u64 = kind(10);
/// Light at these points taken again.
pub(crate) const MESH_AGAIN: u64 = kind(11);
/// Points at which the noise of a mesh's light is measured.
pub(crate) const MESH_PILOT: u64 = kind(12);
/// Gathers at sensors; add the number of the replicate.
pub(crate) const SENSORS: u64 = kind(13);
/// Rays that tell which texels something stands on; add the chart.
pub(crate) const BAKE_HIDDEN: u64 = kind(14);
/// Interpolated texels that are gathered as well; add the number.
pub(crate) const BAKE_CONTROLS: u64 = kind(15);
/// Transmittance maps of clusters. Of what that gives, the cluster and then the direction cell pick the stream.
pub(crate) const MAPS: u64 = kind(16);

/// Irradiance of leaves by lights; of what that gives, the node picks the stream.
pub(crate) const LIGHT_IRRADIANCE: u64 = kind(17);

// Of the seed of a node's exposure.
/// Rays from points that seem hidden; add the round.
pub(crate) const EXPOSURE_AGAIN: u64 = kind(1);

// Of the seed of a pair.
/// The samples that give a link its value; those that decide about it take the seed itself.
pub(crate) const LINK_VALUE: u64 = kind(1);

// Of the seed of cell radiosities.
/// View points of all cells.
pub(crate) const VIEW_POINTS: u64 = kind(1);
/// Directions from the positions of a surface; add the surface.
pub(crate) const POSITION_DIRECTIONS: u64 = kind(2);

// Of the seed of particles.
/// Where particles start; add the number.
pub(crate) const EMISSION: u64 = kind(1);
/// A bounce of all particles; add its number.
pub(crate) const PARTICLE_BOUNCES: u64 = kind(2);

// Of the seed of a bounce.
/// Whether a particle goes on; add its number.
pub(crate) const PARTICLE_SURVIVAL: u64 = kind(1);

// Of the seed of a place.
/// Where the systematic sampling of emitters starts.
pub(crate) const EMITTERS: u64 = kind(1);
/// Pieces of an emitter; add the emitter. Of what that gives, the number of the piece picks the stream.
pub(crate) const EMITTER_PIECES: u64 = kind(2);
/// Draws of cells of reflectors.
pub(crate) const REFLECTORS: u64 = kind(3);
/// The gather at a point of a reflector that was seen; add its number among those seen.
pub(crate) const ON_REFLECTORS: u64 = kind(4);
/// Paths that go on from where their first ray arrives; add the ray.
pub(crate) const PATHS_ONWARD: u64 = kind(5);
/// The next bounce of a path.
pub(crate) const NEXT_BOUNCE: u64 = kind(6);
/// A view point of the cell; add its number.
pub(crate) const VIEW_POINT: u64 = kind(7);
/// A record of the irradiance cache; add 0 or 1 for its gathers, 2 for what is near.
pub(crate) const RECORD: u64 = kind(8);
/// Gathers at a control point of the irradiance cache; add 0 or 1.
pub(crate) const CONTROL_GATHERS: u64 = kind(9);
/// Rays of the pilot of replicates; add the ray.
pub(crate) const REPLICATE_PILOT: u64 = kind(10);
/// Whether a path of little weight goes on.
pub(crate) const ROULETTE: u64 = kind(11);
/// Where a path of a cell starts; add its number.
pub(crate) const START_OF_PATH: u64 = kind(105);
/// Directions towards emitters around which rays are sent.
pub(crate) const TOWARDS: u64 = kind(103);
/// Rays around these; add the number of the direction.
pub(crate) const GUIDED: u64 = kind(104);
/// Paths that look for light at a point of the error estimate; add the round.
pub(crate) const SEARCH: u64 = kind(102);

/// Rays to lights that are no surfaces. Of what that gives, the light or the ray picks the stream.
pub(crate) const LIGHTS: u64 = kind(100);
/// Rays to the sky.
pub(crate) const SKY: u64 = kind(101);

/// A replicate, by its number; add the rays taken before.
pub(crate) const fn replicate(number: u8) -> u64 {
    kind(12 + number)
}

// Of either half of the seed of a shifted Sobol sequence.
/// The bits by which one coordinate is shifted.
pub(crate) const SOBOL_SHIFT: u64 = 7;
/// What takes the place of the seed where the sequence begins anew; add how often it has.
pub(crate) const SOBOL_BLOCK: u64 = kind(1);

// Of a single draw.
/// The second coordinate of a point whose first is drawn by the seed itself, or any other second number.
pub(crate) const SECOND: u64 = 1;
/// A third number.
pub(crate) const THIRD: u64 = 2;
