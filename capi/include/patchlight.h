/*
 * Patchlight: how light spreads in scenes of diffuse polygons, with an error figure. docs/c.md says how this is used.
 *
 * Made by cbindgen from capi/src: change that, not this file. Licence: MIT OR Apache-2.0.
 *
 * What holds for all functions:
 * - A function returns a status, and writes its results only with PATCHLIGHT_OK, or with a status below PATCHLIGHT_INVALID_ARGUMENT
 *   where it says so. patchlight_get_message tells more, thread by thread.
 * - Pointers are NULL or valid for what a function reads and writes, and nobody else changes that during the call. NULL is
 *   refused where nothing else is said. Text is UTF-8 and ends in a zero.
 * - Handles are counted: what is created is released once, and once more for each time that it is retained. A handle that is not alive
 *   is refused, never followed. Any thread may use any handle at any time.
 * - Structs begin with their size: set it to sizeof, and what is not used to zero. Fields may be added at their ends. Where that is not
 *   so, the struct never grows.
 * - A buffer comes with its capacity in items, and a count of the items that there are. With NULL and 0 for the first two, only the
 *   count is told. With a buffer, count may be NULL. The count of text includes the zero at its end.
 * - Functions of the caller's must return: no exception and no longjmp may leave them. They may call the library.
 * - Enumerations may get more values. Lengths are in metres, radiosities in W/m^2.
 */

#ifndef PATCHLIGHT_H
#define PATCHLIGHT_H

#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

// Stands for "none" where a number is told.
#define PATCHLIGHT_NONE UINT64_MAX

// The major version of the header; the library tells its own.
#define PATCHLIGHT_VERSION_MAJOR 0

// The minor version of the header.
#define PATCHLIGHT_VERSION_MINOR 1

// The patch version of the header.
#define PATCHLIGHT_VERSION_PATCH 0

// Stands for "no surface" and for "no plane".
#define PATCHLIGHT_NO_SURFACE UINT32_MAX

// How a call ended. Values may be added within these ranges: 0 is success; 1 to 99: it ended early, and what there is can be read; 100
// and above: it failed, and nothing has changed. Negative values are never used.
enum patchlight_status
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Done.
  PATCHLIGHT_OK = 0,
  // A limit on time or links ended the solve before the requested error was reached, or nothing more could be gained. There is a
  // solution; or, where a mesh was made, a mesh.
  PATCHLIGHT_LIMIT = 1,
  // The memory budget ended the solve before the requested error was reached. There is a solution.
  PATCHLIGHT_MEMORY_LIMIT = 2,
  // The progress function cancelled. Of a solve there is a solution, of values, meshes and pictures nothing.
  PATCHLIGHT_CANCELLED = 3,
  // An argument is NULL where it must not be, not finite, not UTF-8, or does not fit the others.
  PATCHLIGHT_INVALID_ARGUMENT = 100,
  // A handle is NULL, was released, or is of another kind.
  PATCHLIGHT_INVALID_HANDLE = 101,
  // No option has this key.
  PATCHLIGHT_UNKNOWN_OPTION = 102,
  // A value is out of range, or options contradict each other.
  PATCHLIGHT_OUT_OF_RANGE = 103,
  // The scene cannot be used; its diagnostics say why.
  PATCHLIGHT_INVALID_SCENE = 104,
  // The scene is committed and cannot be changed, or not committed and cannot be used.
  PATCHLIGHT_WRONG_STATE = 105,
  // The buffer is too small; the count says how large it must be.
  PATCHLIGHT_BUFFER_TOO_SMALL = 106,
  // There is nothing of that, as bounds in a solution without bounds.
  PATCHLIGHT_NOT_AVAILABLE = 107,
  // A file cannot be read or written.
  PATCHLIGHT_FILE_ERROR = 108,
  // The visibility backend is unknown, not built in, or failed.
  PATCHLIGHT_BACKEND_ERROR = 109,
  // The system has no threads or no memory for this.
  PATCHLIGHT_OUT_OF_RESOURCES = 110,
  // A function of the caller's failed, or gave an answer that cannot be.
  PATCHLIGHT_CALLBACK_ERROR = 111,
  // A mistake in the library; please report it.
  PATCHLIGHT_INTERNAL_ERROR = 199,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum patchlight_status patchlight_status;
#else
typedef int32_t patchlight_status;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// What the numbers of an array are. Values may be added.
enum patchlight_format
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // `float`
  PATCHLIGHT_FLOAT = 1,
  // `double`
  PATCHLIGHT_DOUBLE = 2,
  // `uint32_t`
  PATCHLIGHT_UINT32 = 3,
  // `uint64_t`
  PATCHLIGHT_UINT64 = 4,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum patchlight_format patchlight_format;
#else
typedef uint32_t patchlight_format;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// What a line of the log is. Values may be added.
enum patchlight_log_level
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // What was repaired in a scene, or is suspicious.
  PATCHLIGHT_LOG_WARNING = 1,
  // Key figures.
  PATCHLIGHT_LOG_INFO = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum patchlight_log_level patchlight_log_level;
#else
typedef uint32_t patchlight_log_level;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// What is being worked on. Values may be added.
enum patchlight_stage
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Building the visibility backend and the hierarchy.
  PATCHLIGHT_STAGE_BUILD = 1,
  // Deciding pairs of nodes and making links.
  PATCHLIGHT_STAGE_REFINE = 2,
  // Gathering over links and push-pull.
  PATCHLIGHT_STAGE_GATHER = 3,
  // Estimating the error of what has been found.
  PATCHLIGHT_STAGE_ERROR = 4,
  // Evaluating values at points.
  PATCHLIGHT_STAGE_SAMPLE = 5,
  // Rendering a picture.
  PATCHLIGHT_STAGE_RENDER = 6,
  // Finding the radiosities of cells.
  PATCHLIGHT_STAGE_CELLS = 7,
  // Reading a scene.
  PATCHLIGHT_STAGE_READ = 8,
  // Making the lit mesh.
  PATCHLIGHT_STAGE_MESH = 9,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum patchlight_stage patchlight_stage;
#else
typedef uint32_t patchlight_stage;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// What an option's value is. Values may be added.
enum patchlight_option_type
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // A number: patchlight_options_set_double.
  PATCHLIGHT_OPTION_DOUBLE = 1,
  // A whole number: patchlight_options_set_uint64.
  PATCHLIGHT_OPTION_UINT64 = 2,
  // Yes or no: patchlight_options_set_bool.
  PATCHLIGHT_OPTION_BOOL = 3,
  // A name or other text: patchlight_options_set_text, which takes the others as text too.
  PATCHLIGHT_OPTION_TEXT = 4,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum patchlight_option_type patchlight_option_type;
#else
typedef uint32_t patchlight_option_type;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// What there is to know of an option, as text. Values may be added.
enum patchlight_option_text
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Its key.
  PATCHLIGHT_OPTION_KEY = 1,
  // What it does.
  PATCHLIGHT_OPTION_HELP = 2,
  // What is legal, as in "it must be ...".
  PATCHLIGHT_OPTION_RANGE = 3,
  // What a number of 1 stands for; empty where it needs no unit.
  PATCHLIGHT_OPTION_UNIT = 4,
  // Its value if nobody sets it; empty where that follows from other options or the scene.
  PATCHLIGHT_OPTION_DEFAULT = 5,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum patchlight_option_text patchlight_option_text;
#else
typedef uint32_t patchlight_option_text;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// How serious a diagnostic is. Values may be added.
enum patchlight_severity
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // The scene cannot be used.
  PATCHLIGHT_ERROR = 1,
  // The input was changed: what is solved is not exactly what was given.
  PATCHLIGHT_REPAIR = 2,
  // The input is taken as it is, but may not be what was meant.
  PATCHLIGHT_SUSPICION = 3,
  // Worth knowing; nothing is wrong.
  PATCHLIGHT_NOTE = 4,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum patchlight_severity patchlight_severity;
#else
typedef uint32_t patchlight_severity;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// What a diagnostic is about. Values may be added within these ranges: 1 to 99 are repairs, 100 to 199 suspicions, 200 to 299 notes, 300 to
// 399 errors.
enum patchlight_diagnostic_code
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // A face without area was dropped.
  PATCHLIGHT_DEGENERATE_FACE = 1,
  // A face on the same vertices with the same winding as an earlier one was dropped.
  PATCHLIGHT_DUPLICATE_FACE = 2,
  // A face whose vertices lie in no plane was cut into triangles.
  PATCHLIGHT_NON_PLANAR_FACE = 3,
  // A material library is missing; none of its materials is needed.
  PATCHLIGHT_MISSING_LIBRARY = 4,
  // A material is defined nowhere; it is grey 0.5.
  PATCHLIGHT_MISSING_MATERIAL = 5,
  // Faces that name no material are grey 0.5.
  PATCHLIGHT_NO_MATERIAL = 6,
  // A material without reflectance is grey 0.5.
  PATCHLIGHT_NO_REFLECTANCE = 7,
  // A reflectance of 1 or more was lowered to 0.99.
  PATCHLIGHT_REFLECTANCE_CLAMPED = 8,
  // A negative reflectance or emission was raised to 0.
  PATCHLIGHT_NEGATIVE_VALUE = 9,
  // A material is defined twice; the first definition counts.
  PATCHLIGHT_MATERIAL_DEFINED_TWICE = 10,
  // A texture is missing or cannot be read; its material has one colour.
  PATCHLIGHT_MISSING_TEXTURE = 11,
  // The file is not UTF-8 and was read as Latin-1.
  PATCHLIGHT_NOT_UTF8 = 100,
  // Nothing emits light.
  PATCHLIGHT_NO_LIGHT = 101,
  // A face crosses itself.
  PATCHLIGHT_CROSSING_FACE = 102,
  // Backs of one-sided faces are seen from the fronts of others.
  PATCHLIGHT_BACK_FACE_SEEN = 103,
  // Textures, highlights or transparency were left out.
  PATCHLIGHT_IGNORED_PROPERTY = 104,
  // Statements that are no part of the format were left out.
  PATCHLIGHT_UNKNOWN_KEYWORD = 105,
  // Points, lines, curves and curved surfaces were left out.
  PATCHLIGHT_IGNORED_ELEMENT = 106,
  // A face lies in the front of another, nearer than visibility tells apart.
  PATCHLIGHT_OVERLAP = 107,
  // Part of the light leaves the scene.
  PATCHLIGHT_OPEN = 200,
  // Corners were moved onto the plane of their face by less than the digits of a file are worth.
  PATCHLIGHT_FLATTENED = 201,
  // Part of the surfaces lies inside of closed objects.
  PATCHLIGHT_INSIDE = 202,
  // A concave face was cut into convex pieces, which changes nothing.
  PATCHLIGHT_CONCAVE_FACE = 203,
  // Two faces on the same vertices with opposite winding: the two sides of a sheet.
  PATCHLIGHT_SHEET = 204,
  // The file has a camera: what to give to look through it.
  PATCHLIGHT_FILE_CAMERA = 205,
  // How lights that are no surfaces are read, and what of them is left out.
  PATCHLIGHT_FILE_LIGHTS = 206,
  // A face has a vertex or a material that does not exist.
  PATCHLIGHT_BAD_INDEX = 300,
  // A face has a vertex with a coordinate that is not finite, or too large.
  PATCHLIGHT_BAD_VERTEX = 301,
  // A material has a reflectance or an exitance that is out of range.
  PATCHLIGHT_BAD_MATERIAL = 302,
  // All together makes no scene, as without any face.
  PATCHLIGHT_BAD_SCENE = 303,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum patchlight_diagnostic_code patchlight_diagnostic_code;
#else
typedef uint32_t patchlight_diagnostic_code;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// A number that tells about a scene. Values may be added.
enum patchlight_scene_figure
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Channels.
  PATCHLIGHT_SCENE_CHANNELS = 1,
  // Materials.
  PATCHLIGHT_SCENE_MATERIALS = 2,
  // Surfaces: convex planar polygons with one side each.
  PATCHLIGHT_SCENE_SURFACES = 3,
  // The area of all surfaces in m^2.
  PATCHLIGHT_SCENE_AREA = 4,
  // Occluding triangles.
  PATCHLIGHT_SCENE_TRIANGLES = 5,
  // Up to this distance from a triangle's plane an end of a segment counts as lying in it, in metres.
  PATCHLIGHT_SCENE_CONTACT_TOLERANCE = 6,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum patchlight_scene_figure patchlight_scene_figure;
#else
typedef uint32_t patchlight_scene_figure;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// How a file is read: flags to be added up. Values may be added.
enum patchlight_file_flags
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // What it names, such as material libraries, beside it and below its folder alone.
  PATCHLIGHT_FILE_DEFAULT = 0,
  // What it names wherever it says that lies.
  PATCHLIGHT_FILE_ALLOW_ANY_PATH = 1,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum patchlight_file_flags patchlight_file_flags;
#else
typedef uint32_t patchlight_file_flags;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Which sides of a face emit and receive. Values may be added.
enum patchlight_sides
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // The front, where the corners run counter-clockwise.
  PATCHLIGHT_SIDES_FRONT = 0,
  // Both.
  PATCHLIGHT_SIDES_BOTH = 1,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum patchlight_sides patchlight_sides;
#else
typedef uint32_t patchlight_sides;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// A number that tells about a solution. Values may be added; from 100 on they are of the solve, and not there in a solution that was read
// from a file; one that follows from another has those of its error.
enum patchlight_figure
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Channels.
  PATCHLIGHT_CHANNELS = 1,
  // Bytes that hierarchy, links and radiosities take.
  PATCHLIGHT_MEMORY_BYTES = 2,
  // Visibility rays that a value at a point takes.
  PATCHLIGHT_POINT_RAYS = 3,
  // The error that was asked for.
  PATCHLIGHT_ERROR_REQUESTED = 100,
  // The error that is claimed for values at points: an upper confidence limit; infinite where nothing was, or can be, estimated.
  PATCHLIGHT_ERROR_ESTIMATE = 101,
  // The measured error itself.
  PATCHLIGHT_ERROR_MEASURED = 102,
  // The probability with which the claim holds.
  PATCHLIGHT_ERROR_CONFIDENCE = 103,
  // The error that is claimed by energy.
  PATCHLIGHT_ERROR_ENERGY = 104,
  // The error that is claimed locally.
  PATCHLIGHT_ERROR_LOCAL = 105,
  // The part of the area of reflecting surfaces where light was found.
  PATCHLIGHT_LIT = 106,
  // A proven bound of the error of values at points; only where bounds were asked for.
  PATCHLIGHT_ERROR_BOUND = 107,
  // Visibility rays of the solve.
  PATCHLIGHT_RAYS = 108,
  // 1 if the requested error is reached, else 0.
  PATCHLIGHT_CONVERGED = 109,
  // The error that is claimed for the mesh, that of the values it was made from included; only where it was asked for.
  PATCHLIGHT_ERROR_MESH = 110,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum patchlight_figure patchlight_figure;
#else
typedef uint32_t patchlight_figure;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// What an array of a solution has items for. Values may be added.
enum patchlight_items
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // The surfaces of the scene.
  PATCHLIGHT_SURFACES = 1,
  // The elements: surfaces that were not split, and the smallest pieces of the others.
  PATCHLIGHT_ELEMENTS = 2,
  // All nodes: clusters, surfaces, elements, and what lies between them, by their numbers.
  PATCHLIGHT_NODES = 3,
  // The links, by receiver.
  PATCHLIGHT_LINKS = 4,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum patchlight_items patchlight_items;
#else
typedef uint32_t patchlight_items;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Real numbers for each item. Values may be added.
enum patchlight_real
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Of surfaces, elements, nodes: radiosity in W/m^2, by channel.
  PATCHLIGHT_RADIOSITY = 1,
  // No point of it has less, in W/m^2, by channel; where bounds were asked for.
  PATCHLIGHT_LOWER = 2,
  // No point of it has more.
  PATCHLIGHT_UPPER = 3,
  // Area in m^2.
  PATCHLIGHT_AREA = 4,
  // The corners of its polygon, three coordinates each, counter-clockwise; as many as PATCHLIGHT_CORNER_COUNT says.
  PATCHLIGHT_CORNERS = 5,
  // Of links: the form factor from receiver to source, occlusion included: an unbiased sample.
  PATCHLIGHT_FORM_FACTOR = 20,
  // Of links: the form factor as if nothing were in between.
  PATCHLIGHT_UNOCCLUDED_FORM_FACTOR = 21,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum patchlight_real patchlight_real;
#else
typedef uint32_t patchlight_real;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// A whole number for each item. Values may be added.
enum patchlight_whole
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Of surfaces, elements, nodes: the number of the node.
  PATCHLIGHT_NODE = 1,
  // The node above; the root is its own.
  PATCHLIGHT_PARENT = 2,
  // The surface that it is or is a piece of; UINT32_MAX for a cluster.
  PATCHLIGHT_SURFACE = 3,
  // The face of the input that it comes from; UINT32_MAX for a cluster.
  PATCHLIGHT_FACE = 4,
  // Its material; UINT32_MAX for a cluster.
  PATCHLIGHT_MATERIAL = 5,
  // How many corners its polygon has; 0 for a cluster.
  PATCHLIGHT_CORNER_COUNT = 6,
  // Of links: the node that gathers.
  PATCHLIGHT_RECEIVER = 20,
  // Of links: the node that is gathered from.
  PATCHLIGHT_SOURCE = 21,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum patchlight_whole patchlight_whole;
#else
typedef uint32_t patchlight_whole;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// A number that tells about a mesh. Values may be added.
enum patchlight_mesh_figure
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Channels.
  PATCHLIGHT_MESH_CHANNELS = 1,
  // Nodes.
  PATCHLIGHT_MESH_NODE_COUNT = 2,
  // Elements.
  PATCHLIGHT_MESH_ELEMENT_COUNT = 3,
  // How far the mesh is off the values at points, relative to these: measured at points that had no part in making it.
  PATCHLIGHT_MESH_MEASURED = 4,
  // An upper confidence limit of that. What the values are off the truth comes on top: the whole is the root of both squares.
  PATCHLIGHT_MESH_CLAIMED = 5,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum patchlight_mesh_figure patchlight_mesh_figure;
#else
typedef uint32_t patchlight_mesh_figure;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// What an array of a mesh holds. Values may be added.
enum patchlight_mesh_array
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // For each node its position, three coordinates in metres. Elements of one surface share nodes, but where light may have a step.
  PATCHLIGHT_MESH_POSITIONS = 1,
  // For each node its radiosity in W/m^2, by channel.
  PATCHLIGHT_MESH_RADIOSITY = 2,
  // For each element its six nodes, by their places in the arrays of nodes: three corners, counter-clockwise from the front, then the
  // middles of the edges from the first to the second, from that to the third, and back.
  PATCHLIGHT_MESH_ELEMENT_NODES = 3,
  // For each element the surface that it lies on.
  PATCHLIGHT_MESH_ELEMENT_SURFACE = 4,
  // For each element the standard error of what is read there, in W/m^2, all channels together: the root of the sum of their squares, in the mean
  // over the element. NaN where it is not known, as with other weights of light groups.
  PATCHLIGHT_MESH_ELEMENT_ERROR = 5,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum patchlight_mesh_array patchlight_mesh_array;
#else
typedef uint32_t patchlight_mesh_array;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// How lights are grouped. Values may be added.
enum patchlight_light_grouping
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Not at all, as at first.
  PATCHLIGHT_LIGHTS_TOGETHER = 0,
  // A group for each material that emits, by its name, and for each light that is no surface.
  PATCHLIGHT_LIGHTS_BY_MATERIAL = 1,
  // A group for each object of a file that has emitters, and for each light that is no surface.
  PATCHLIGHT_LIGHTS_BY_OBJECT = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum patchlight_light_grouping patchlight_light_grouping;
#else
typedef uint32_t patchlight_light_grouping;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Worker threads, and who hears what happens. Scenes, solves and solutions of a context use its threads.
typedef struct patchlight_context patchlight_context;

// Radiosity as a function on the surfaces: elements with six nodes each, between which it is quadratic. Unchangeable; may be read by many
// threads. Keeps the solution that it is of.
typedef struct patchlight_mesh patchlight_mesh;

// What is asked of a solve: options by their keys, those of `patchlight solve --set key=value`.
typedef struct patchlight_options patchlight_options;

// What is lit. Put together, then committed, and unchangeable from there on.
typedef struct patchlight_scene patchlight_scene;

// The answer: radiosities of everything, and what values at points and pictures are made from. Unchangeable; may be read by many threads.
typedef struct patchlight_solution patchlight_solution;

// Hears lines of the log: its own data, a patchlight_log_level, and a line that is gone when it returns. Called on the thread that called
// the library, during that call.
typedef void (*patchlight_log_function)(void *user, uint32_t level, const char *line);

// A pinhole camera.
typedef struct patchlight_camera {
  // `sizeof(patchlight_camera)`
  size_t size;
  // Width of the picture in pixels.
  uint32_t width;
  // Height of the picture in pixels.
  uint32_t height;
  // The eye, in metres.
  double eye[3];
  // What is at the centre of the picture.
  double target[3];
  // What points up in the picture; not parallel to the view.
  double up[3];
  // Vertical field of view in degrees, above 0 and below 180.
  double field_of_view;
} patchlight_camera;

// An array that is written: items with a number of components each, which lie one behind the other.
typedef struct patchlight_buffer {
  // `sizeof(patchlight_buffer)`
  size_t size;
  // What the components become: a patchlight_format.
  uint32_t format;
  // The first item. Need not be aligned.
  void *data;
  // How many items there is room for.
  size_t capacity;
  // Bytes from one item to the next; 0 if they lie one behind the other. What lies between items is left as it is.
  size_t stride;
} patchlight_buffer;

// An array that is read: items with a number of components each, which lie one behind the other.
typedef struct patchlight_array {
  // `sizeof(patchlight_array)`
  size_t size;
  // What the components are: a patchlight_format.
  uint32_t format;
  // The first item. Need not be aligned.
  const void *data;
  // How many items there are.
  size_t count;
  // Bytes from one item to the next; 0 if they lie one behind the other.
  size_t stride;
} patchlight_array;

// What was noted about a scene.
typedef struct patchlight_diagnostic {
  // `sizeof(patchlight_diagnostic)`
  size_t size;
  // What it is about: a patchlight_diagnostic_code.
  uint32_t code;
  // How serious it is: a patchlight_severity.
  uint32_t severity;
  // The number of the face in the arrays or in the file, from 0, or PATCHLIGHT_NONE. Texts count faces from 1.
  uint64_t face;
  // The line in the file, from 1, or PATCHLIGHT_NONE.
  uint64_t line;
} patchlight_diagnostic;

// How far work is.
typedef struct patchlight_progress {
  // `sizeof(patchlight_progress)` of the library: fields beyond it are not there.
  size_t size;
  // A patchlight_stage.
  uint32_t stage;
  // The round of refinement, from 1; 0 outside of rounds.
  uint32_t round;
  // Links so far.
  uint64_t links;
  // Elements so far.
  uint64_t elements;
  // The part of the stage that is done, 0 to 1; below 0 where it is not known.
  double fraction;
  // The last error estimate; below 0 where there is none.
  double error;
} patchlight_progress;

// Hears how far work is, with its own data; not 0 to cancel. Called on worker threads, by one at a time.
typedef int32_t (*patchlight_progress_function)(void *user, const struct patchlight_progress *progress);

// The open segment between two points. Never grows.
typedef struct patchlight_segment {
  // One end, in metres.
  double from[3];
  // The other end, in metres.
  double to[3];
  // Triangles of this plane do not count; PATCHLIGHT_NO_SURFACE for an end in no plane.
  uint32_t from_plane;
  // Triangles of this plane do not count either.
  uint32_t to_plane;
} patchlight_segment;

// Says of each segment whether a triangle blocks it: 1 or 0. Returns 0, or anything else to say that it failed, which ends the work.
typedef int32_t (*patchlight_occluded_function)(void *user,
                                                const struct patchlight_segment *segments,
                                                size_t count,
                                                uint8_t *occluded);

// A half-line. Never grows.
typedef struct patchlight_ray {
  // Where it starts, in metres.
  double origin[3];
  // Where it goes; need not have length 1.
  double direction[3];
  // Triangles of this plane do not count; PATCHLIGHT_NO_SURFACE for an origin in no plane.
  uint32_t origin_plane;
  // Zero.
  uint32_t reserved;
} patchlight_ray;

// The first triangle that a ray meets. Never grows.
typedef struct patchlight_hit {
  // In lengths of the ray's direction, above 0.
  double distance;
  // The surface of the triangle, as patchlight_scene_triangle_planes tells; PATCHLIGHT_NO_SURFACE if nothing is met.
  uint32_t surface;
  // Is left as it is.
  uint32_t reserved;
} patchlight_hit;

// Says of each ray what it meets first; `hits` are filled with "nothing" beforehand. Returns 0, or anything else to say that it failed.
typedef int32_t (*patchlight_first_hits_function)(void *user,
                                                  const struct patchlight_ray *rays,
                                                  size_t count,
                                                  struct patchlight_hit *hits);

// Is told that its data are not needed any more.
typedef void (*patchlight_release_function)(void *user);

// Who answers visibility, in batches of about a thousand: for the triangles of patchlight_scene_triangles, each of which blocks from either
// side.
//
// A triangle blocks a segment if the segment passes through it, it lies in neither plane that does not count, and the ends lie on different
// sides of its plane, each farther from it than PATCHLIGHT_SCENE_CONTACT_TOLERANCE. A ray is a segment without a far end. The functions are
// called on worker threads, by many at once, and must give the same answer to the same question. They are not asked about what is not
// finite or has no length.
typedef struct patchlight_visibility {
  // `sizeof(patchlight_visibility)`
  size_t size;
  // Handed to the functions as it is.
  void *user;
  // Must be there.
  patchlight_occluded_function occluded;
  // Must be there.
  patchlight_first_hits_function first_hits;
  // Called once when nothing asks any more: the solve failed, or its solution was let go. May be NULL.
  patchlight_release_function release;
} patchlight_visibility;

// Hears, with its own data, how many bytes a solve would take now, before it takes more: not 0 to refuse them, which ends the solve as the
// option `memory` does, with PATCHLIGHT_MEMORY_LIMIT and a solution. Bytes are counted as that option counts them, all that the solve holds
// and the program itself. Called on worker threads, by one at a time for each solve.
typedef int32_t (*patchlight_memory_function)(void *user, uint64_t bytes);

// How a scene is solved. What is zero is left to the library.
typedef struct patchlight_solve_info {
  // `sizeof(patchlight_solve_info)`
  size_t size;
  // What is asked for; NULL for all defaults. Later changes of them change nothing here.
  struct patchlight_options *options;
  // Hears how far it is, and may cancel; may be NULL.
  patchlight_progress_function progress;
  // Handed to `progress` as it is.
  void *progress_user;
  // Who answers visibility; NULL for the backend that the options name. The struct is copied.
  const struct patchlight_visibility *visibility;
  // Hears how much memory is taken, and may refuse more; may be NULL.
  patchlight_memory_function memory;
  // Handed to `memory` as it is.
  void *memory_user;
} patchlight_solve_info;

// Where values at points are written, point after point, with a number for each channel. What is NULL is left out.
typedef struct patchlight_values {
  // `sizeof(patchlight_values)`
  size_t size;
  // How many numbers each buffer has room for: at least points times channels.
  size_t capacity;
  // Radiosities in W/m^2; NaN at points that lie on no surface.
  float *radiosity;
  // Their standard errors in W/m^2; NaN where they are not known.
  float *standard_error;
  // No less, proved; where bounds were asked for.
  float *lower;
  // No more, proved.
  float *upper;
} patchlight_values;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// Makes a context with so many worker threads; 0 takes one for each core. The number never changes an answer.
patchlight_status patchlight_context_create(uint32_t threads, struct patchlight_context **context);

// Makes a context that uses the worker threads of another.
patchlight_status patchlight_context_create_sharing(struct patchlight_context *other,
                                                    struct patchlight_context **context);

// One more patchlight_context_release is needed.
patchlight_status patchlight_context_retain(struct patchlight_context *context);

// Lets a context go. What was made with it keeps what it needs. NULL is let go by.
patchlight_status patchlight_context_release(struct patchlight_context *context);

// How many worker threads a context has.
patchlight_status patchlight_context_threads(struct patchlight_context *context, uint32_t *threads);

// Sets who hears the log of a context; NULL for nobody, as at first. `user` is handed to the function as it is.
patchlight_status patchlight_context_set_log(struct patchlight_context *context,
                                             patchlight_log_function function,
                                             void *user);

// The mesh of a solution, as it was solved or loaded. PATCHLIGHT_NOT_AVAILABLE if it has none: they come with the option `lit_mesh`.
patchlight_status patchlight_solution_get_mesh(struct patchlight_solution *solution,
                                               struct patchlight_mesh **mesh);

// Makes a mesh, whether the solution has one or not, that is off the values at points by no more than `error`, above 0 and below 1. The progress function of the solution hears how
// far it is, and may cancel. PATCHLIGHT_LIMIT if less cannot be claimed than what PATCHLIGHT_MESH_CLAIMED tells: there is a mesh.
patchlight_status patchlight_solution_make_mesh(struct patchlight_solution *solution,
                                                double error,
                                                struct patchlight_mesh **mesh);

// One more patchlight_mesh_release is needed.
patchlight_status patchlight_mesh_retain(struct patchlight_mesh *mesh);

// Lets a mesh go. NULL is let go by.
patchlight_status patchlight_mesh_release(struct patchlight_mesh *mesh);

// A number that tells about a mesh: `what` is a patchlight_mesh_figure.
patchlight_status patchlight_mesh_get_figure(struct patchlight_mesh *mesh, uint32_t what, double *figure);

// Takes a picture of a mesh: as patchlight_solution_get_picture, but at once and without grain, since it only reads the mesh. The progress
// function of the solution hears of it.
patchlight_status patchlight_mesh_get_picture(struct patchlight_mesh *mesh,
                                              const struct patchlight_camera *camera,
                                              float *radiance,
                                              size_t capacity,
                                              size_t *count);

// Takes a picture of a mesh and writes it, as patchlight_solution_write_picture does.
patchlight_status patchlight_mesh_write_picture(struct patchlight_mesh *mesh,
                                                const struct patchlight_camera *camera,
                                                const char *path);

// Writes a mesh, `.ply`, `.glb` for viewers or `.vtp` for ParaView: four triangles for each element, with radiosities at their corners.
patchlight_status patchlight_mesh_export(struct patchlight_mesh *mesh,
                                         const char *path);

// Writes an array of a mesh: `what` is a patchlight_mesh_array. Without a buffer only the count of items is told.
patchlight_status patchlight_mesh_get_array(struct patchlight_mesh *mesh,
                                            uint32_t what,
                                            const struct patchlight_buffer *buffer,
                                            size_t *count);

// Reads a mesh at points that lie on surfaces, with the normals of the sides that are looked at: radiosities in W/m^2 by channel, an item for
// each point, NaN where it lies on no surface. `missed` says how many do; it may be NULL.
patchlight_status patchlight_mesh_get_values(struct patchlight_mesh *mesh,
                                             const struct patchlight_array *positions,
                                             const struct patchlight_array *normals,
                                             const struct patchlight_buffer *radiosity,
                                             size_t *missed);

// Makes options, all with their defaults.
patchlight_status patchlight_options_create(struct patchlight_options **options);

// One more patchlight_options_release is needed.
patchlight_status patchlight_options_retain(struct patchlight_options *options);

// Lets options go. NULL is let go by.
patchlight_status patchlight_options_release(struct patchlight_options *options);

// Sets an option that is a number.
patchlight_status patchlight_options_set_double(struct patchlight_options *options, const char *key, double value);

// Sets an option that is a whole number.
patchlight_status patchlight_options_set_uint64(struct patchlight_options *options, const char *key, uint64_t value);

// Sets an option that is yes (not 0) or no (0).
patchlight_status patchlight_options_set_bool(struct patchlight_options *options, const char *key, int32_t value);

// Sets any option from text, as `--set key=value` does.
patchlight_status patchlight_options_set_text(struct patchlight_options *options, const char *key, const char *value);

// Sets an option back to its default.
patchlight_status patchlight_options_reset(struct patchlight_options *options, const char *key);

// The value of an option as text.
//
// PATCHLIGHT_NOT_AVAILABLE if nobody has set it and it follows from other options or the scene.
patchlight_status patchlight_options_get_text(struct patchlight_options *options,
                                              const char *key,
                                              char *buffer,
                                              size_t capacity,
                                              size_t *count);

// How many options there are. A later version may have more, in another order.
patchlight_status patchlight_option_count(size_t *count);

// What the value of an option is: a patchlight_option_type. Options are numbered from 0.
patchlight_status patchlight_option_get_type(size_t option, uint32_t *value_type);

// What there is to know of an option: `what` is a patchlight_option_text. Options are numbered from 0.
patchlight_status patchlight_option_get_text(size_t option,
                                             uint32_t what,
                                             char *buffer,
                                             size_t capacity,
                                             size_t *count);

// Makes a scene without anything in it. `channels` is 1 for grey, 3 for linear Rec. 709, or the number of bands, up to 1024; `sides` is a
// patchlight_sides.
patchlight_status patchlight_scene_create(struct patchlight_context *context,
                                          uint32_t channels,
                                          uint32_t sides,
                                          struct patchlight_scene **scene);

// One more patchlight_scene_release is needed.
patchlight_status patchlight_scene_retain(struct patchlight_scene *scene);

// Lets a scene go. Its solutions keep what they need. NULL is let go by.
patchlight_status patchlight_scene_release(struct patchlight_scene *scene);

// Adds materials, numbered in the order in which they are added, from 0. The items of `reflectance` are reflectances by channel, from 0 to
// below 1, those of `exitance` are the power that is emitted, by channel, in W/m^2.
patchlight_status patchlight_scene_add_materials(struct patchlight_scene *scene,
                                                 const struct patchlight_array *reflectance,
                                                 const struct patchlight_array *exitance);

// Adds vertices, numbered in the order in which they are added, from 0. An item has three coordinates in metres.
patchlight_status patchlight_scene_add_vertices(struct patchlight_scene *scene,
                                                const struct patchlight_array *positions);

// Adds faces, numbered in the order in which they are added, from 0.
//
// `corners` are numbers of vertices, face after face, counter-clockwise seen from the front; they may be added later. `counts` says how
// many corners each face has; NULL stands for triangles. `materials` says which material each has; NULL stands for material 0. All three
// have one whole number an item.
patchlight_status patchlight_scene_add_faces(struct patchlight_scene *scene,
                                             const struct patchlight_array *corners,
                                             const struct patchlight_array *counts,
                                             const struct patchlight_array *materials);

// Adds what is in a file (`.obj`, `.gltf`, `.glb`, `.ply`, `.stl`), for scenes of three channels. `flags` are of patchlight_file_flags. Its faces
// and materials are numbered behind those of arrays.
patchlight_status patchlight_scene_add_file(struct patchlight_scene *scene,
                                            const char *path,
                                            uint32_t flags);

// Adds the lights of a TOML file, which are no surfaces: points, spots, measured luminaires, suns and skies. `flags` are of patchlight_file_flags.
patchlight_status patchlight_scene_add_lights(struct patchlight_scene *scene,
                                              const char *path,
                                              uint32_t flags);

// Validates a scene, and makes it ready to be solved. What was repaired or is suspicious, and if it fails all that is wrong, can be read as
// diagnostics. A scene that failed may be added to, and committed again.
patchlight_status patchlight_scene_commit(struct patchlight_scene *scene);

// How many diagnostics the last commit of a scene left.
patchlight_status patchlight_scene_diagnostic_count(struct patchlight_scene *scene, size_t *count);

// A diagnostic of a scene, numbered from 0. `diagnostic` is filled in as far as its size says that the caller knows it.
patchlight_status patchlight_scene_diagnostic(struct patchlight_scene *scene,
                                              size_t number,
                                              struct patchlight_diagnostic *diagnostic);

// The text of a diagnostic of a scene.
patchlight_status patchlight_scene_diagnostic_text(struct patchlight_scene *scene,
                                                   size_t number,
                                                   char *buffer,
                                                   size_t capacity,
                                                   size_t *count);

// Groups the lights of a scene that is not committed yet: `grouping` is a patchlight_light_grouping. patchlight_scene_commit finds the groups, and
// patchlight_solution_relight weights them after the solve.
patchlight_status patchlight_scene_group_lights(struct patchlight_scene *scene,
                                                uint32_t grouping);

// Adds lights to the group of a name, which is made with its first ones: `lights` is "material NAME", "object NAME" or "light NAME". Every surface that
// emits must be in one group then, and every light. Takes the place of what patchlight_scene_group_lights said.
patchlight_status patchlight_scene_add_to_light_group(struct patchlight_scene *scene,
                                                      const char *group,
                                                      const char *lights);

// A number that tells about a committed scene: `what` is a patchlight_scene_figure.
patchlight_status patchlight_scene_get_figure(struct patchlight_scene *scene, uint32_t what, double *figure);

// The occluding triangles of a committed scene, for a visibility backend of the caller's own: the positions of their corners in metres, nine
// numbers each.
patchlight_status patchlight_scene_triangles(struct patchlight_scene *scene,
                                             double *positions,
                                             size_t capacity,
                                             size_t *count);

// Surface and plane of each occluding triangle of a committed scene, two numbers each. Triangles in one plane have the same number.
patchlight_status patchlight_scene_triangle_planes(struct patchlight_scene *scene,
                                                   uint32_t *surfaces_and_planes,
                                                   size_t capacity,
                                                   size_t *count);

// One more patchlight_solution_release is needed.
patchlight_status patchlight_solution_retain(struct patchlight_solution *solution);

// Lets a solution go. NULL is let go by.
patchlight_status patchlight_solution_release(struct patchlight_solution *solution);

// Sets who hears how far values at points, meshes and pictures are, and may cancel them; NULL for nobody, as at first.
patchlight_status patchlight_solution_set_progress(struct patchlight_solution *solution,
                                                   patchlight_progress_function progress,
                                                   void *user);

// How the solve ended, as patchlight_solve said. PATCHLIGHT_NOT_AVAILABLE for one that was read from a file or follows from another.
patchlight_status patchlight_solution_get_status(struct patchlight_solution *solution,
                                                 patchlight_status *status);

// Writes a solution, to be read by patchlight_solution_load and by the program. A file that is there is replaced by a complete one.
patchlight_status patchlight_solution_save(struct patchlight_solution *solution,
                                           const char *path);

// Writes the elements of a solution with their radiosities: `.ply`, `.glb` for viewers or `.vtp` for ParaView.
patchlight_status patchlight_solution_export(struct patchlight_solution *solution, const char *path);

// Reads a solution that this version wrote. Of `info`, which may be NULL, the backend counts, or the visibility. Nothing in the file is
// trusted before it is checked.
patchlight_status patchlight_solution_load(struct patchlight_context *context,
                                           const char *path,
                                           const struct patchlight_solve_info *info,
                                           struct patchlight_solution **solution);

// Sets a camera that shows the scene. The width and height that it has are kept.
patchlight_status patchlight_solution_get_camera(struct patchlight_solution *solution,
                                                 struct patchlight_camera *camera);

// Takes a picture: radiances in W/m^2/sr, row after row from the top left, with a number for each channel of a pixel. `standard_error` is
// NULL, or has as much room.
patchlight_status patchlight_solution_get_picture(struct patchlight_solution *solution,
                                                  const struct patchlight_camera *camera,
                                                  float *radiance,
                                                  float *standard_error,
                                                  size_t capacity,
                                                  size_t *count);

// Takes a picture and writes it: `.png` to look at, exposed automatically, or `.exr` with linear radiances.
patchlight_status patchlight_solution_write_picture(struct patchlight_solution *solution,
                                                    const struct patchlight_camera *camera,
                                                    const char *path);

// How many items a solution has: `items` is a patchlight_items.
patchlight_status patchlight_solution_count(struct patchlight_solution *solution, uint32_t items, size_t *count);

// A whole number for each item: `items` is a patchlight_items, `what` a patchlight_whole.
patchlight_status patchlight_solution_get_uint32(struct patchlight_solution *solution,
                                                 uint32_t items,
                                                 uint32_t what,
                                                 uint32_t *buffer,
                                                 size_t capacity,
                                                 size_t *count);

// Real numbers for each item: `items` is a patchlight_items, `what` a patchlight_real.
patchlight_status patchlight_solution_get_double(struct patchlight_solution *solution,
                                                 uint32_t items,
                                                 uint32_t what,
                                                 double *buffer,
                                                 size_t capacity,
                                                 size_t *count);

// A number that tells about a solution: `what` is a patchlight_figure.
patchlight_status patchlight_solution_get_figure(struct patchlight_solution *solution, uint32_t what, double *figure);

// What the solve tells about itself, as JSON: the report of the program, but for what only a program knows.
patchlight_status patchlight_solution_get_report(struct patchlight_solution *solution,
                                                 char *buffer,
                                                 size_t capacity,
                                                 size_t *count);

// How many light groups a solution has; 0 for one that was solved without.
patchlight_status patchlight_solution_light_group_count(struct patchlight_solution *solution, size_t *count);

// The name of a light group, counted from 0, and the zero behind it.
patchlight_status patchlight_solution_light_group_name(struct patchlight_solution *solution,
                                                       size_t group,
                                                       char *buffer,
                                                       size_t capacity,
                                                       size_t *count);

// A solution with other weights for its light groups: a weighted sum of what is stored, exact and quick. An item of `weights` is a group, in
// their order, with a weight from 0 on for each channel; as it was solved they are 1. What is known of its error is by energy:
// PATCHLIGHT_ERROR_ESTIMATE and PATCHLIGHT_ERROR_ENERGY. Visibility and the progress function are those of `solution`, which stays as it is.
patchlight_status patchlight_solution_relight(struct patchlight_solution *solution,
                                              const struct patchlight_array *weights,
                                              struct patchlight_solution **relit);

// A solution of the same surfaces with other materials, over the transport that was stored with the option `keep_transport`: no ray is cast. Items are the
// materials, in their order, with a number for each channel, as in patchlight_scene_add_materials; NULL leaves reflectances or exitances as they
// are. PATCHLIGHT_LIMIT if more than `error` is claimed, or where that is 0 more than the solution was asked for: there is a solution. The progress
// function of `solution`, which stays as it is, may cancel. PATCHLIGHT_NOT_AVAILABLE without stored transport.
patchlight_status patchlight_solution_with_materials(struct patchlight_solution *solution,
                                                     const struct patchlight_array *reflectance,
                                                     const struct patchlight_array *exitance,
                                                     double error,
                                                     struct patchlight_solution **changed);

// Values at points that lie on surfaces, with the normals of the sides that are looked at. `missed` says how many lie on no surface; it may be
// NULL.
patchlight_status patchlight_solution_get_values(struct patchlight_solution *solution,
                                                 const struct patchlight_array *positions,
                                                 const struct patchlight_array *normals,
                                                 const struct patchlight_values *values,
                                                 size_t *missed);

// Solves a committed scene on the threads of a context. `info` may be NULL.
//
// A solve that a limit ends, or that is cancelled, leaves a solution as well, and a status below PATCHLIGHT_INVALID_ARGUMENT says so.
patchlight_status patchlight_solve(struct patchlight_context *context,
                                   struct patchlight_scene *scene,
                                   const struct patchlight_solve_info *info,
                                   struct patchlight_solution **solution);

// The version of the library.
patchlight_status patchlight_get_version(uint32_t *major, uint32_t *minor, uint32_t *patch);

// What the last other call on this thread has to tell, in English; empty after PATCHLIGHT_OK. It stays where it is until the next call on
// this thread.
patchlight_status patchlight_get_message(const char **message);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* PATCHLIGHT_H */
