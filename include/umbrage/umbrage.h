/* Umbrage's C interface: a scene in, a picture out; or the G-buffer of another renderer in, shaded planes out.
 *
 * C99 or later. C++ programs may use umbrage/umbrage.hpp, a layer over this header. The guide is docs/c.md.
 *
 * Handles. An object starts with one reference. umbRetain... adds one, umbRelease... drops one, the last one frees it.
 * Objects retain those that they were made with. Releasing NULL does nothing.
 *
 * Errors. A function that can fail returns a UmbError and leaves a sentence with the object, which keeps the first one
 * until somebody asks: see umbGetJobError. A function that makes an object returns NULL, and leaves the error with the
 * thread: see umbGetError. So do calls with a NULL handle, which return UMB_ERROR_USAGE, and those on an object that is
 * in use. Nothing throws, ends the process or prints.
 *
 * Callbacks must not throw. From within one the library may be called, but not on the object whose call calls back, the
 * job that executes or the scene that loads; nor may the scene of that job be changed, nor another job, of any device,
 * be executed or prepared. These calls return UMB_ERROR_USAGE. Retaining, releasing, errors and counters are free. An
 * error callback runs after its call, and may use all objects; of what fails within it, it is not told.
 *
 * Threads. Different threads may use different objects at the same time. While a function changes, executes or loads an
 * object, calls of other threads on it return UMB_ERROR_USAGE, or what stands for nothing, and do nothing. Functions
 * that only read, such as umbGetJobOutput, may be called side by side; a change waits until they are done. Functions of
 * devices, retaining and releasing (by who has a reference), errors and counters are free at any time. Jobs of one
 * device wait for each other; a callback must not wait for a thread that executes one. Jobs of several devices may draw
 * one scene at the same time; while one does, the scene cannot be changed: UMB_ERROR_USAGE. Strings, strokes and images
 * that an object returns are for the thread that uses it next.
 *
 * Spaces. World space is the scene's. View space is right-handed: +x right, +y up, the camera looks down -z. Depth is
 * the positive distance along the view axis, +infinity where there is no surface. Normals are unit vectors in view
 * space that face the camera, 0 where there is no surface. Row 0 of an image is the top one. Light is linear Rec. 709.
 * The pass "color" is the finished picture, sRGB, as an 8-bit file holds it, alpha not premultiplied.
 *
 * Strings are UTF-8. A string that a function returns belongs to the library. It lives as long as its object, or, of
 * errors, until the next call of the same function. */
#ifndef UMBRAGE_UMBRAGE_H
#define UMBRAGE_UMBRAGE_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Of this header; umbGetVersion returns that of the library. */
#define UMB_VERSION_MAJOR 0
#define UMB_VERSION_MINOR 1
#define UMB_VERSION_PATCH 0
#define UMB_VERSION (UMB_VERSION_MAJOR * 10000 + UMB_VERSION_MINOR * 100 + UMB_VERSION_PATCH)

#define UMB_API __attribute__((visibility("default")))

#ifdef __cplusplus
extern "C" {
#endif

typedef struct UmbDeviceObject* UmbDevice; /* what computes: the CPU or a GPU */
typedef struct UmbSceneObject* UmbScene;   /* meshes, materials and lights */
typedef struct UmbJobObject* UmbJob;       /* makes pictures, and keeps what the next one can use */

/* The values are the exit codes of the command line. */
typedef enum UmbError {
  UMB_ERROR_NONE = 0,
  UMB_ERROR_INTERNAL = 1,   /* a defect of Umbrage */
  UMB_ERROR_USAGE = 2,      /* a name, value, image or call that cannot be */
  UMB_ERROR_FILE = 3,       /* a file that cannot be read, used or written */
  UMB_ERROR_DEVICE = 4,     /* a device that is missing or cannot do it, or too little memory */
  UMB_ERROR_CANCELLED = 130 /* the progress callback returned false */
} UmbError;

/* Both are called by the thread that called the library. `message` is valid during the call. */
typedef void (*UmbErrorCallback)(void* user, UmbError code, const char* message);
typedef void (*UmbLogCallback)(void* user, const char* message); /* warnings, such as a missing texture */
/* Called some 20 times a second with the share that is done, from 0 to 1, never falling. Returns whether to go on. */
typedef bool (*UmbProgressCallback)(void* user, double done);

/* UMB_VERSION of the library. */
UMB_API int umbGetVersion(void);

/* The last error of this thread that belongs to no object, since somebody asked; then there is none. `message` may be
 * NULL; it is valid until the thread's next call of this function. */
UMB_API UmbError umbGetError(const char** message);

/* ---- Devices ---- */

/* `name`: "cpu", "vulkan", "vulkan:N", or "auto": a GPU if there is one; NULL: "auto". `threads`: 0 to 1024, of the
 * CPU; 0: as many as the machine has. Errors: UMB_ERROR_USAGE; UMB_ERROR_DEVICE. */
UMB_API UmbDevice umbNewDevice(const char* name, int threads);
UMB_API void umbRetainDevice(UmbDevice device);
UMB_API void umbReleaseDevice(UmbDevice device);
/* One line for people: "vulkan:0: NVIDIA ..."; NULL for a NULL handle. */
UMB_API const char* umbGetDeviceDescription(UmbDevice device);
/* Bytes of GPU memory that it holds; 0 on the CPU. */
UMB_API uint64_t umbGetDeviceMemory(UmbDevice device);
/* Called for each error of the device, its scenes and its jobs, by the thread whose call failed. NULL: nothing is
 * called. */
UMB_API UmbError umbSetDeviceErrorCallback(UmbDevice device, UmbErrorCallback callback, void* user);
/* Called for each warning of its scenes and jobs. */
UMB_API UmbError umbSetDeviceLogCallback(UmbDevice device, UmbLogCallback callback, void* user);
/* The first error since the last call; then there is none. `message` may be NULL; it is valid until the next call. */
UMB_API UmbError umbGetDeviceError(UmbDevice device, const char** message);

/* ---- Images ---- */

typedef enum UmbType {
  UMB_TYPE_FLOAT32 = 1,
  UMB_TYPE_FLOAT16 = 2,
  UMB_TYPE_UINT8 = 3,  /* 0 to 255 mean 0 to 1; of ids the number itself */
  UMB_TYPE_UINT16 = 4, /* 0 to 65535 mean 0 to 1; of ids the number itself */
  UMB_TYPE_UINT32 = 5  /* ids alone */
} UmbType;

/* Pixels in the caller's memory. Strides are in bytes and may be negative; 0 means packed: channels side by side, then
 * pixels, then rows. Of a job's images and outputs `channels` of 0 are as many as the pass has. `data` is channel 0 of
 * the upper left pixel. */
typedef struct UmbImage {
  void* data;
  int32_t type; /* UmbType */
  int32_t width, height, channels;
  ptrdiff_t channel_stride, pixel_stride, row_stride;
} UmbImage;

/* ---- Scenes ---- */

/* An empty scene. Models are added to it as they stand in their files, and meshes from memory. It serves jobs of any
 * device; errors are told to this one's callback. */
UMB_API UmbScene umbNewScene(UmbDevice device);
UMB_API void umbRetainScene(UmbScene scene);
UMB_API void umbReleaseScene(UmbScene scene);
/* The first error since the last call: see umbGetDeviceError. */
UMB_API UmbError umbGetSceneError(UmbScene scene, const char** message);
UMB_API UmbError umbSetSceneProgressCallback(UmbScene scene, UmbProgressCallback callback, void* user);

/* How what follows is added: "up" (axis "+Z" or "x,y,z"), "crease_angle_deg", "point_size", "point_sprites",
 * "scene_index", written as on the command line. NULL or "": as at first. */
UMB_API UmbError umbSetSceneParameter(UmbScene scene, const char* name, const char* value);

/* Adds a model: a file, or "scene:NAME?detail=N". Errors: UMB_ERROR_USAGE for a scene or index that there is not;
 * UMB_ERROR_FILE; UMB_ERROR_DEVICE where memory is short; UMB_ERROR_CANCELLED. The scene is then as it was. */
UMB_API UmbError umbLoadModel(UmbScene scene, const char* model);

/* Adds a mesh of so many vertices and triangles and returns its number; below 0: an error. Without triangles it is a
 * cloud of points. It is part of the scene once its positions and indices are set; without normals these are made. */
UMB_API int umbAddMesh(UmbScene scene, const char* name, size_t vertices, size_t triangles);

/* Takes a mesh out of the scene. Its number is not given to another one. */
UMB_API UmbError umbRemoveMesh(UmbScene scene, int mesh);

/* Copies a buffer of the caller's: "position" (3 channels, FLOAT32), "normal" (3), "color" (3 or 4, linear if floats,
 * sRGB if integers), "uv" (2, (0, 0) is the lower left corner), "radius" (1, of points, above 0), each of one value a
 * vertex; or "index" (3 a triangle: UINT32, UINT16 or UINT8). `stride`: bytes from an element to the next, 0: packed.
 * Errors: UMB_ERROR_USAGE, also for an index beyond the vertices. */
UMB_API UmbError umbSetMeshBuffer(UmbScene scene, int mesh, const char* name, const void* data, UmbType type,
                                  int channels, ptrdiff_t stride);

/* The mesh's material: "albedo" (3), "specular" (1, peak of the highlight), "shininess" (1, Blinn-Phong exponent),
 * "emission" (3), "alpha_cutoff" (1: parts of the texture with less alpha are cut away). Colours and textures multiply
 * albedo, which starts at 0.8, or at 1 where the mesh has some of them. */
UMB_API UmbError umbSetMeshFloats(UmbScene scene, int mesh, const char* name, const float* values, int count);

/* "albedo" or "emission": an image of UINT8, 3 or 4 channels, sRGB with linear alpha, that multiplies the parameter of
 * that name. It is copied. */
UMB_API UmbError umbSetMeshTexture(UmbScene scene, int mesh, const char* name, const UmbImage* image);

/* Puts the mesh at a place. Without instances it is where its buffers say; with some, at their places alone, each with
 * an object id of its own. `world_from_mesh`: the upper three rows of a matrix, row by row. Errors: UMB_ERROR_USAGE for
 * numbers that are not finite. */
UMB_API UmbError umbAddMeshInstance(UmbScene scene, int mesh, const float world_from_mesh[12]);

/* The box that holds the scene. Errors: UMB_ERROR_USAGE for an empty one. */
UMB_API UmbError umbGetSceneBounds(UmbScene scene, float lower[3], float upper[3]);
/* Cameras that the scene's files hold. */
UMB_API int umbGetSceneCameraCount(UmbScene scene);

/* ---- Jobs ---- */

/* Renders a scene. */
UMB_API UmbJob umbNewRenderJob(UmbDevice device, UmbScene scene);
/* Shades the G-buffer that umbSetJobImage gives. */
UMB_API UmbJob umbNewShadeJob(UmbDevice device);
UMB_API void umbRetainJob(UmbJob job);
UMB_API void umbReleaseJob(UmbJob job);
/* The first error since the last call: see umbGetDeviceError. */
UMB_API UmbError umbGetJobError(UmbJob job, const char** message);
UMB_API UmbError umbSetJobProgressCallback(UmbJob job, UmbProgressCallback callback, void* user);

/* Parameters. The names are those that umbGetParameter lists for "render" and "shade", such as "look", "width" or
 * "camera.position", and those of effects, such as "bitmask.radius". A setter whose type is not the parameter's is
 * UMB_ERROR_USAGE; a string is taken for all, written as on the command line. NULL or "" resets it. */
UMB_API UmbError umbSetJobString(UmbJob job, const char* name, const char* value);
UMB_API UmbError umbSetJobBool(UmbJob job, const char* name, bool value);
UMB_API UmbError umbSetJobInt(UmbJob job, const char* name, int value);
UMB_API UmbError umbSetJobFloat(UmbJob job, const char* name, float value);
UMB_API UmbError umbSetJobFloats(UmbJob job, const char* name, const float* values, int count);
/* As if it had never been set. NULL: all of them. */
UMB_API UmbError umbResetJobParameter(UmbJob job, const char* name);

/* An input of a shade job: "depth" (always), "normal", "albedo", "object_id", ..., or "layer1.depth". The pixels are
 * read while the job executes, and must live until then; the UmbImage itself is copied. NULL: none any more. */
UMB_API UmbError umbSetJobImage(UmbJob job, const char* name, const UmbImage* image);

/* Where a pass is to be written: "color", "depth", "ao", ..., or "all" of them. A `data` of NULL has the library keep
 * it: see umbGetJobOutput. For integer types numbers are clamped to 0 to 1 and rounded, but for ids: where there is no
 * surface these have all bits set, or are 0 if they are the caller's. NULL: not wanted any more. Without any output a
 * job makes "color", or what the last one of its "effects" makes. */
UMB_API UmbError umbSetJobOutput(UmbJob job, const char* name, const UmbImage* image);

/* Does what comes before the first picture of a render job: reads the image around the scene, builds the hierarchy.
 * umbExecuteJob does it where nobody has. Errors: UMB_ERROR_USAGE, UMB_ERROR_FILE, UMB_ERROR_DEVICE,
 * UMB_ERROR_CANCELLED. */
UMB_API UmbError umbPrepareJob(UmbJob job);

/* Makes the picture. What is the same as the last time is kept: the device, the scene's hierarchy, what the camera sees
 * where effects alone have changed, and memory. A scene without lights stays lit as its first picture's camera stood.
 * On failure the job may go on; its outputs are undefined after UMB_ERROR_DEVICE, and else as they were. */
UMB_API UmbError umbExecuteJob(UmbJob job);

/* An output of the last execution: where the caller wanted it, or float and packed in the library's memory, which lives
 * until the next execution. Errors: UMB_ERROR_USAGE for one that was not made. */
UMB_API UmbError umbGetJobOutput(UmbJob job, const char* name, UmbImage* image);
/* The outputs of the last execution, one after the other; NULL beyond the last. */
UMB_API const char* umbGetJobOutputName(UmbJob job, int index);

/* Lines as curves, where the parameter "strokes" is set and the look draws some. A polyline with round ends and joins,
 * whose width changes linearly from point to point; pixels from the picture's upper left corner. They live until the
 * next execution. */
typedef enum UmbStrokeKind {
  UMB_STROKE_OUTLINE = 0, /* an object ends */
  UMB_STROKE_FOLD = 1,    /* an object hides a part of itself */
  UMB_STROKE_CREASE = 2   /* two faces meet */
} UmbStrokeKind;
typedef struct UmbStrokePoint {
  float x, y, width;
} UmbStrokePoint;
typedef struct UmbStroke {
  const UmbStrokePoint* points;
  size_t point_count;
  int32_t kind;       /* UmbStrokeKind */
  uint32_t object_id; /* of the nearer surface */
  int32_t closed;     /* the last point is the first one again */
} UmbStroke;
UMB_API size_t umbGetJobStrokeCount(UmbJob job);
UMB_API UmbError umbGetJobStroke(UmbJob job, size_t index, UmbStroke* stroke);

/* Red, green and blue of the strokes, sRGB, and the opacity of all of them together. */
UMB_API UmbError umbGetJobStrokeColor(UmbJob job, float rgb[3], float* opacity);

/* Whether the parameters are right, as far as can be said without the scene or the images. Errors: UMB_ERROR_USAGE. */
UMB_API UmbError umbCheckJob(UmbJob job);

/* Counters of all executions of the job: "hierarchies_built", "captures_made", "planes_copied" (of inputs). -1: there
 * is no such counter. */
UMB_API int64_t umbGetJobCounter(UmbJob job, const char* name);

/* ---- Files ---- */

/* Writes images, each a pass by its name, whole or not at all: .png and .pfm take "color" or one pass of 1 or 3
 * channels, .exr takes all. In .png values are clamped to 0 to 1. Alpha is left out where all pixels are opaque.
 * `bits`: 8 or 16, of .png; `half`: 16-bit floats in .exr where they suffice. Errors, of umbGetError: UMB_ERROR_USAGE;
 * UMB_ERROR_FILE. */
UMB_API UmbError umbWriteImages(const char* file, const char* const* names, const UmbImage* images, int count, int bits,
                                bool half);
/* Writes strokes as .svg, for a picture of that size. */
UMB_API UmbError umbWriteStrokes(const char* file, int width, int height, const UmbStroke* strokes, size_t count,
                                 const float rgb[3], float opacity);

/* ---- What there is ---- */

typedef enum UmbList {
  UMB_LIST_LOOKS = 1,
  UMB_LIST_EFFECTS = 2,
  UMB_LIST_OCCLUSIONS = 3, /* values of the parameter "occlusion" */
  UMB_LIST_DEVICES = 4,    /* usable ones: this asks the driver */
  UMB_LIST_SCENES = 5,     /* built in */
  UMB_LIST_FILE_FORMATS = 6
} UmbList;
/* A name and one line about it. Both live as long as the library. UMB_ERROR_USAGE, and no error
 * to be asked for, beyond the last one. */
UMB_API UmbError umbGetListEntry(UmbList list, int index, const char** name, const char** summary);

typedef struct UmbParameter {
  size_t size;      /* set to sizeof(UmbParameter) before the call: later versions add members at the end */
  const char* name; /* as the setters take it */
  const char* type; /* "bool", "int", "float", "float3", "float4", "float9", "string", "length" or "choice" */
  const char* help;
  const char* unit;    /* "deg", "px", "%", "scene units", or "" for a plain number or text */
  const char* initial; /* what holds where it is not set, in words; "": it is found from the scene */
  const char* choices; /* values of a "choice", separated by spaces; or "" */
  double min, max;     /* of numbers; both 0: no range */
} UmbParameter;
/* How many channels a pass has, of inputs and outputs; 0: no effect reads or makes one of that name. */
UMB_API int umbGetPassChannels(const char* pass);

/* The parameters of "render", "shade", "scene" or an effect. Of a smaller `size`, as an older header has it, the first
 * members are filled; of a larger one those that this library has, the others are 0. Errors: UMB_ERROR_USAGE; beyond
 * the last one the same, and no error to be asked for. */
UMB_API UmbError umbGetParameter(const char* owner, int index, UmbParameter* parameter);

#ifdef __cplusplus
}
#endif
#endif
