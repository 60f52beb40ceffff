/* Umbrage's C interface: renders a scene to a picture, or shades the G-buffer of another renderer.
 *
 * C99 or later. C++ programs may use umbrage/umbrage.hpp, a layer over this header. The guide is docs/c.md.
 *
 * Handles. A new object has one reference. umbRetain... adds a reference and umbRelease... removes one; removing the
 * last reference frees the object. An object retains the objects that it was created with. Releasing NULL does nothing.
 *
 * Errors. A function that can fail returns a UmbError and stores a message with the object. The object keeps the first
 * error until it is read: see umbGetJobError. A function that creates an object returns NULL on failure and stores the
 * error with the thread: see umbGetError. Calls with a NULL handle, and calls on an object that is in use, also store
 * their error with the thread; those that return a UmbError return UMB_ERROR_USAGE. No function throws, ends the
 * process or prints.
 *
 * Callbacks must not throw. A callback may call the library, except for calls on the object whose call invoked it (the
 * job that executes or the scene that loads), calls that change the scene of that job, and calls that execute or
 * prepare another job of any device. Those calls return UMB_ERROR_USAGE. Retaining, releasing, and reading errors and
 * counters are always allowed. An error callback runs after the call that failed has ended, and may use all objects;
 * errors of calls that it makes are not reported to it.
 *
 * Threads. Different threads may use different objects at the same time. While a function changes, executes or loads an
 * object, calls of other threads on that object do nothing and return UMB_ERROR_USAGE, or an empty value such as NULL
 * or 0. Functions that only read, such as umbGetJobOutput, may run concurrently on one object; a change waits until
 * they are done. The following may be called at any time: functions of devices, retaining and releasing (by a caller
 * that owns a reference), and functions that read errors and counters. Jobs of one device execute one after the other,
 * so a callback must not wait for a thread that executes a job. Jobs of several devices may draw one scene at the same
 * time; while one of them draws, the scene cannot be changed: UMB_ERROR_USAGE. Strings, strokes and images that an
 * object returns are valid only until the calls that their functions name; the caller keeps other threads from making
 * those calls too early.
 *
 * Spaces. World space is the scene's. View space is right-handed: +x right, +y up, the camera looks down -z. Depth is
 * the positive distance along the view axis, +infinity where there is no surface. Normals are unit vectors in view
 * space that face the camera, 0 where there is no surface. Row 0 of an image is the top row. Light is linear Rec. 709.
 * The pass "color" is the finished picture: sRGB, as in an 8-bit file, with straight (not premultiplied) alpha.
 *
 * Strings are UTF-8. A string that a function returns belongs to the library. It is valid as long as its object; an
 * error message is valid until the next call of the function that returned it. */
#ifndef UMBRAGE_UMBRAGE_H
#define UMBRAGE_UMBRAGE_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Version of this header. umbGetVersion returns the version of the library. */
#define UMB_VERSION_MAJOR 0
#define UMB_VERSION_MINOR 2
#define UMB_VERSION_PATCH 0
#define UMB_VERSION (UMB_VERSION_MAJOR * 10000 + UMB_VERSION_MINOR * 100 + UMB_VERSION_PATCH)

#define UMB_API __attribute__((visibility("default")))

#ifdef __cplusplus
extern "C" {
#endif

typedef struct UmbDeviceObject* UmbDevice; /* a compute device: the CPU or a GPU */
typedef struct UmbSceneObject* UmbScene;   /* meshes, materials and lights */
typedef struct UmbJobObject* UmbJob;       /* makes pictures; keeps data that the next picture can reuse */

/* Error codes. The values are the exit codes of the command line. */
typedef enum UmbError {
  UMB_ERROR_NONE = 0,
  UMB_ERROR_INTERNAL = 1,   /* a defect of Umbrage */
  UMB_ERROR_USAGE = 2,      /* an invalid name, value, image or call */
  UMB_ERROR_FILE = 3,       /* a file that cannot be read, used or written */
  UMB_ERROR_DEVICE = 4,     /* a missing or insufficient device, or too little memory */
  UMB_ERROR_CANCELLED = 130 /* the progress callback returned false */
} UmbError;

/* Receives errors and warnings, such as a missing texture. The thread that called the library calls it. `message` is
 * valid during the call. */
typedef void (*UmbErrorCallback)(void* user, UmbError code, const char* message);
typedef void (*UmbLogCallback)(void* user, const char* message);
/* Receives the fraction of the work that is done, 0 to 1, never decreasing, about 20 times a second. Returns whether to
 * continue. */
typedef bool (*UmbProgressCallback)(void* user, double done);

/* Returns the UMB_VERSION of the library. */
UMB_API int umbGetVersion(void);

/* Returns and clears the last error of the calling thread that belongs to no object; UMB_ERROR_NONE if there is none.
 * `message` may be NULL; the string is valid until the thread's next call of this function. */
UMB_API UmbError umbGetError(const char** message);

/* ---- Devices ---- */

/* Opens a device. `name`: "cpu", "vulkan", "vulkan:N", or "auto" (a GPU if there is one); NULL means "auto". `threads`:
 * number of CPU threads, 0 to 1024; 0 means as many as the machine has. Errors: UMB_ERROR_USAGE; UMB_ERROR_DEVICE. */
UMB_API UmbDevice umbNewDevice(const char* name, int threads);
UMB_API void umbRetainDevice(UmbDevice device);
UMB_API void umbReleaseDevice(UmbDevice device);
/* Returns one line for display, such as "vulkan:0: NVIDIA ..."; NULL for a NULL handle. */
UMB_API const char* umbGetDeviceDescription(UmbDevice device);
/* Returns the GPU memory that the device has allocated, in bytes; 0 on the CPU. */
UMB_API uint64_t umbGetDeviceMemory(UmbDevice device);
/* Sets the callback for errors of the device, its scenes and its jobs. The thread whose call failed calls it. NULL
 * removes the callback. */
UMB_API UmbError umbSetDeviceErrorCallback(UmbDevice device, UmbErrorCallback callback, void* user);
/* Sets the callback for warnings of the device's scenes and jobs. NULL removes the callback. */
UMB_API UmbError umbSetDeviceLogCallback(UmbDevice device, UmbLogCallback callback, void* user);
/* Returns and clears the first error since the last call of this function; UMB_ERROR_NONE if there is none. `message`
 * may be NULL; the string is valid until the next call. */
UMB_API UmbError umbGetDeviceError(UmbDevice device, const char** message);

/* ---- Images ---- */

typedef enum UmbType {
  UMB_TYPE_FLOAT32 = 1,
  UMB_TYPE_FLOAT16 = 2,
  UMB_TYPE_UINT8 = 3,  /* 0 to 255 mean 0 to 1; ids are stored as integers */
  UMB_TYPE_UINT16 = 4, /* 0 to 65535 mean 0 to 1; ids are stored as integers */
  UMB_TYPE_UINT32 = 5  /* for ids only */
} UmbType;

/* Pixels in the caller's memory. Strides are in bytes and may be negative; 0 means packed: interleaved channels, then
 * pixels, then rows. For images and outputs of a job, `channels` of 0 means as many as the pass has. `data` points to
 * channel 0 of the upper left pixel. */
typedef struct UmbImage {
  void* data;
  int32_t type; /* UmbType */
  int32_t width, height, channels;
  ptrdiff_t channel_stride, pixel_stride, row_stride;
} UmbImage;

/* ---- Scenes ---- */

/* Creates an empty scene, to which models from files and meshes from memory are added. Models keep the positions that
 * their files give. Jobs of any device can draw the scene; its errors are reported to the callback of `device`. */
UMB_API UmbScene umbNewScene(UmbDevice device);
UMB_API void umbRetainScene(UmbScene scene);
UMB_API void umbReleaseScene(UmbScene scene);
/* Returns and clears the first error since the last call of this function: see umbGetDeviceError. */
UMB_API UmbError umbGetSceneError(UmbScene scene, const char** message);
UMB_API UmbError umbSetSceneProgressCallback(UmbScene scene, UmbProgressCallback callback, void* user);

/* Sets a parameter for models and meshes that are added later: "up" (axis "+Z" or "x,y,z"), "crease_angle_deg",
 * "point_size", "point_sprites", "scene_index", "animation_index", "animation_time", "lights", "color_by" (the field of
 * values that is read from files, for jobs with the same parameter). `value` is written as on the command line; NULL or
 * "" restores the default. */
UMB_API UmbError umbSetSceneParameter(UmbScene scene, const char* name, const char* value);

/* Adds a model: a file, or "scene:NAME?detail=N". Errors: UMB_ERROR_USAGE for an unknown scene name or index;
 * UMB_ERROR_FILE; UMB_ERROR_DEVICE if memory runs out; UMB_ERROR_CANCELLED. On failure the scene is unchanged. */
UMB_API UmbError umbLoadModel(UmbScene scene, const char* model);

/* Adds a mesh with the given numbers of vertices and triangles and returns its number, or a negative value on failure.
 * A mesh without triangles is a point cloud. The mesh is drawn once its positions and indices are set. Missing normals
 * are computed. */
UMB_API int umbAddMesh(UmbScene scene, const char* name, size_t vertices, size_t triangles);

/* Removes a mesh from the scene. Its number is not reused. */
UMB_API UmbError umbRemoveMesh(UmbScene scene, int mesh);

/* Copies a buffer of the caller to the mesh. Buffers with one element per vertex: "position" (3 channels, FLOAT32),
 * "normal" (3, FLOAT32), "color" (3 or 4; FLOAT32 is linear, UINT8 and UINT16 are sRGB), "uv" (2, FLOAT32; (0, 0) is
 * the lower left corner), "radius" (1, FLOAT32, > 0, of points). One element per triangle: "index" (3; UINT32, UINT16
 * or UINT8). `stride`: bytes from one element to the next, 0: packed. Errors: UMB_ERROR_USAGE, also for an index beyond
 * the vertices. */
UMB_API UmbError umbSetMeshBuffer(UmbScene scene, int mesh, const char* name, const void* data, UmbType type,
                                  int channels, ptrdiff_t stride);

/* Copies values to the mesh, such as a pressure, which a job shows as colours if its parameter "color_by" is their
 * name. `of_triangles`: one per triangle; otherwise one per vertex. `type`: FLOAT32, UINT8, UINT16 or UINT32; NaN:
 * there is no value. `components`: 1 to 16; `stride`: bytes from one value to the next, 0: packed. */
UMB_API UmbError umbSetMeshValues(UmbScene scene, int mesh, const char* name, bool of_triangles, const void* data,
                                  UmbType type, int components, ptrdiff_t stride);

/* Sets a material parameter: "albedo" (3 values), "specular" (1, peak of the highlight), "shininess" (1, Blinn-Phong
 * exponent), "emission" (3), "alpha_cutoff" (1; parts of the texture with a smaller alpha are cut out). Vertex colours
 * and textures multiply the albedo, whose default is 0.8, or 1 if the mesh has colours or an albedo texture. */
UMB_API UmbError umbSetMeshFloats(UmbScene scene, int mesh, const char* name, const float* values, int count);

/* Copies a texture to the mesh. `name`: "albedo" or "emission", the parameter that the texture multiplies. The image is
 * UINT8 with 3 or 4 channels, sRGB with linear alpha. */
UMB_API UmbError umbSetMeshTexture(UmbScene scene, int mesh, const char* name, const UmbImage* image);

/* Adds an instance of the mesh. A mesh without instances is drawn where its buffers place it; a mesh with instances is
 * drawn at these only, and each instance has its own object id. `world_from_mesh`: the upper three rows of a matrix,
 * row by row. Errors: UMB_ERROR_USAGE for values that are not finite. */
UMB_API UmbError umbAddMeshInstance(UmbScene scene, int mesh, const float world_from_mesh[12]);

/* Returns the axis-aligned bounding box of the scene. Errors: UMB_ERROR_USAGE for an empty scene. */
UMB_API UmbError umbGetSceneBounds(UmbScene scene, double lower[3], double upper[3]);
/* Returns the number of cameras that "camera.index" can select. */
UMB_API int umbGetSceneCameraCount(UmbScene scene);

/* ---- Jobs ---- */

/* Creates a job that renders a scene. */
UMB_API UmbJob umbNewRenderJob(UmbDevice device, UmbScene scene);
/* Creates a job that shades a G-buffer: images set by umbSetJobImage, or files named by the parameter "file", whose
 * layers are recognised, or by "depth_file", "normal_file" and so on. */
UMB_API UmbJob umbNewShadeJob(UmbDevice device);
UMB_API void umbRetainJob(UmbJob job);
UMB_API void umbReleaseJob(UmbJob job);
/* Returns and clears the first error since the last call of this function: see umbGetDeviceError. */
UMB_API UmbError umbGetJobError(UmbJob job, const char** message);
UMB_API UmbError umbSetJobProgressCallback(UmbJob job, UmbProgressCallback callback, void* user);

/* Sets a parameter. `name` is one that umbGetParameter lists for "render" or "shade", such as "look", "width" or
 * "camera.position", or one of an effect, such as "bitmask.radius". Each parameter takes the setter of its type; all
 * take umbSetJobString, with the value written as on the command line. NULL or "" restores the default. Errors:
 * UMB_ERROR_USAGE, also for a setter of another type. */
UMB_API UmbError umbSetJobString(UmbJob job, const char* name, const char* value);
UMB_API UmbError umbSetJobBool(UmbJob job, const char* name, bool value);
UMB_API UmbError umbSetJobInt(UmbJob job, const char* name, int value);
UMB_API UmbError umbSetJobFloat(UmbJob job, const char* name, float value);
UMB_API UmbError umbSetJobFloats(UmbJob job, const char* name, const float* values, int count);
/* For positions in files with coordinates that exceed the precision of floats. */
UMB_API UmbError umbSetJobDoubles(UmbJob job, const char* name, const double* values, int count);
/* Restores the default of a parameter; NULL: of all parameters. */
UMB_API UmbError umbResetJobParameter(UmbJob job, const char* name);

/* Sets an input of a shade job: "depth" (required), "normal", "albedo", "object_id", ..., or "layer1.depth". The
 * UmbImage is copied. Its pixels are not: they are read while the job executes, and must stay valid until then. NULL
 * removes the input. */
UMB_API UmbError umbSetJobImage(UmbJob job, const char* name, const UmbImage* image);

/* Requests a pass: "color", "beauty" (the picture as .exr files hold it: scene-linear light, exposed, before the tone
 * curve, premultiplied; 4 channels), "depth", "ao", ..., or "all" passes. The pass is written to `image`; if its `data`
 * is NULL, the library allocates the memory, for values of its `type`, or of FLOAT32 if that is 0: see umbGetJobOutput.
 * Integer types: values are clamped to 0 to 1, scaled to the type's range and rounded; ids are written as integers. A
 * pixel without a surface has an id with all bits set, or 0 if the ids come from an image of the caller. NULL removes
 * the request. A job without outputs makes "color", or, if "effects" is set, the passes of the last effect. */
UMB_API UmbError umbSetJobOutput(UmbJob job, const char* name, const UmbImage* image);

/* Does the work that precedes the first picture of a render job: reads the environment image and builds the ray-tracing
 * acceleration structure. umbExecuteJob does this work if it has not been done. For the files of a shade job, it only
 * finds what they hold: see umbGetJobFact. Errors: UMB_ERROR_USAGE, UMB_ERROR_FILE, UMB_ERROR_DEVICE,
 * UMB_ERROR_CANCELLED. */
UMB_API UmbError umbPrepareJob(UmbJob job);

/* Makes the picture. Reuses data of the last execution that is still valid: the device, the scene's acceleration
 * structure, the captured G-buffer if only effects have changed, and memory. A scene without lights gets lights that
 * are placed relative to the camera of each picture; those for a camera inside the scene are kept. After a failure the
 * job can be executed again; its outputs are undefined after UMB_ERROR_DEVICE, and unchanged after other errors. A
 * picture of more than 67108864 pixels, summed over its layers, is UMB_ERROR_USAGE: the programs `umbrage render` and
 * `umbrage shade` draw such pictures. The files of a shade job are read each time. */
UMB_API UmbError umbExecuteJob(UmbJob job);

/* Returns an output of the last execution: the caller's image, or a packed image in memory of the library, which is
 * valid until the next execution. The library's images are of the requested type; those of ids that come from an image
 * of the caller are UINT32. Errors: UMB_ERROR_USAGE for an output that was not made. */
UMB_API UmbError umbGetJobOutput(UmbJob job, const char* name, UmbImage* image);
/* Returns the name of an output of the last execution; NULL beyond the last one. */
UMB_API const char* umbGetJobOutputName(UmbJob job, int index);

/* Strokes are the lines of a picture as curves. They are made if the parameter "strokes" is set and the look draws
 * lines. A stroke is a polyline with round caps and joins, whose width changes linearly from point to point. Points are
 * in pixels from the picture's upper left corner. Strokes are valid until the next execution. */
typedef enum UmbStrokeKind {
  UMB_STROKE_OUTLINE = 0,     /* border of an object */
  UMB_STROKE_FOLD = 1,        /* an object occludes a part of itself */
  UMB_STROKE_CREASE = 2,      /* two faces meet */
  UMB_STROKE_HATCH = 3,       /* hatching along a surface */
  UMB_STROKE_CROSS_HATCH = 4, /* hatching that crosses other hatching */
  UMB_STROKE_HIDDEN = 5       /* a dash of an edge behind the visible surface */
} UmbStrokeKind;
typedef struct UmbStrokePoint {
  float x, y, width;
} UmbStrokePoint;
typedef struct UmbStroke {
  const UmbStrokePoint* points;
  size_t point_count;
  int32_t kind;       /* UmbStrokeKind */
  uint32_t object_id; /* of the nearer surface */
  int32_t closed;     /* not 0: the last point coincides with the first */
} UmbStroke;
UMB_API size_t umbGetJobStrokeCount(UmbJob job);
UMB_API UmbError umbGetJobStroke(UmbJob job, size_t index, UmbStroke* stroke);

/* Returns the sRGB colour of the strokes, and the opacity of all of them together. */
UMB_API UmbError umbGetJobStrokeColor(UmbJob job, float rgb[3], float* opacity);

/* A camera. `view_from_world`: the upper three rows of a rigid transform from the coordinates of the models' files, row
 * by row; the camera looks along -z, with +x right and +y up. `left` to `top`: the picture's borders, at distance 1 or,
 * if `orthographic`, in scene units. */
typedef struct UmbView {
  double view_from_world[12];
  float left, right, bottom, top;
  int32_t orthographic; /* 0 or 1 */
} UmbView;
/* Returns the camera of the last picture; for files the one that they hold, or that was found from their values.
 * Errors: UMB_ERROR_USAGE for a job that has made none, and for images of the caller. */
UMB_API UmbError umbGetJobView(UmbJob job, UmbView* view);

/* Return a fact about the files of a shade job, such as "depth: ViewLayer.Depth.Z, planar, background 1e+10", and a
 * layer of these files with its channels, such as "ViewLayer.Depth (Z)"; NULL beyond the last one. Facts are found by
 * umbPrepareJob, which also describes files that hold no G-buffer, and by umbExecuteJob; a text is valid until the next
 * call of these. Warnings about the files go to the log callback of the device. */
UMB_API const char* umbGetJobFact(UmbJob job, int index);
UMB_API const char* umbGetJobFileLayer(UmbJob job, int index);

/* Checks the parameters as far as possible without the scene and the images. Errors: UMB_ERROR_USAGE. */
UMB_API UmbError umbCheckJob(UmbJob job);

/* Returns a counter over all executions of the job: "hierarchies_built", "captures_made", "planes_copied" (of inputs);
 * -1 for an unknown name. */
UMB_API int64_t umbGetJobCounter(UmbJob job, const char* name);

/* ---- Files ---- */

/* Writes images to a file, completely or not at all. Each image has the name of its pass. .png, .jpg, .webp and .pfm
 * take "color" or one pass of 1 or 3 channels, .exr takes any number of passes. .png, .jpg and .webp clamp values to 0
 * to 1, and omit alpha if all pixels are opaque; .jpg has no alpha. R, G, B and A of .exr are scene-linear and
 * premultiplied: the image "beauty" as it is, or else "color" with its sRGB encoding removed, whose tone curve remains.
 * `bits`: 8 or 16, for .png; `half`: .exr stores 16-bit floats where they suffice. Errors (see umbGetError):
 * UMB_ERROR_USAGE; UMB_ERROR_FILE. */
UMB_API UmbError umbWriteImages(const char* file, const char* const* names, const UmbImage* images, int count, int bits,
                                bool half);
/* Does the same, and stores the camera of the picture in .exr, as `worldToCamera` and `worldToNDC`. `view` may be NULL.
 */
UMB_API UmbError umbWriteImagesOfView(const char* file, const char* const* names, const UmbImage* images, int count,
                                      int bits, bool half, const UmbView* view);
/* Writes strokes to a .svg file. `width` and `height`: size of the picture, pixels. Errors: as umbWriteImages. */
UMB_API UmbError umbWriteStrokes(const char* file, int width, int height, const UmbStroke* strokes, size_t count,
                                 const float rgb[3], float opacity);

/* ---- Lists ---- */

typedef enum UmbList {
  UMB_LIST_LOOKS = 1,
  UMB_LIST_EFFECTS = 2,
  UMB_LIST_OCCLUSIONS = 3, /* values of the parameter "occlusion" */
  UMB_LIST_DEVICES = 4,    /* usable devices; queries the driver */
  UMB_LIST_SCENES = 5,     /* built-in scenes */
  UMB_LIST_FILE_FORMATS = 6
} UmbList;
/* Returns a name and a summary of one line, which are valid as long as the library is loaded. Beyond the last entry it
 * returns UMB_ERROR_USAGE and stores no error. */
UMB_API UmbError umbGetListEntry(UmbList list, int index, const char** name, const char** summary);

typedef struct UmbParameter {
  size_t size;      /* set to sizeof(UmbParameter) before the call: later versions add members at the end */
  const char* name; /* for the setters */
  const char* type; /* "bool", "int", "float", "float2", "float3", "float4", "float9", "string", "length" or "choice" */
  const char* help;
  const char* unit;    /* "deg", "px", "%", "scene units", or "" for a plain number or text */
  const char* initial; /* default, in words; "": derived from the scene */
  const char* choices; /* values of a "choice", separated by spaces; or "" */
  double min, max;     /* range of a number; both 0: no range */
} UmbParameter;
/* Returns the number of channels of an input or output pass; 0: no effect reads or writes a pass of that name. */
UMB_API int umbGetPassChannels(const char* pass);

/* Returns a parameter of "render", "shade", "scene" or an effect. If `size` is smaller than the library's, as with an
 * older header, only the first members are filled; if it is larger, the members that the library lacks are 0. Errors:
 * UMB_ERROR_USAGE; beyond the last parameter it returns UMB_ERROR_USAGE and stores no error. */
UMB_API UmbError umbGetParameter(const char* owner, int index, UmbParameter* parameter);

#ifdef __cplusplus
}
#endif
#endif
