#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "tracer/scene/load/obj.h"
#include "tracer/scene/material.h"

namespace becalm::tracer {

/// A material of an MTL file, and the light that it emits.
struct MtlMaterial {
  Material material;
  V3f emission{0.0f};  ///< radiance: Ke, times the mean colour of map_Ke
};

/// Reads the `wanted` materials, or all, of a Wavefront material file, with the physically based extension of
/// its fields; their images are added to the textures, paths relative to the file. Not to be called by two
/// threads with the same textures.
///
/// Materials with any of Pr, Pm, Ps, Pc, Pcr, aniso, anisor or their maps are principled; without these,
/// illum 4, 6, 7 and 9 are a dielectric (Ni if it is at least 1, or 1.5; Tf, or 1), illum 3 and 5 with a Ks a
/// conductor of that reflectance, and all else principled. Roughness is Pr, or that of the Phong exponent Ns
/// with the same slope: alpha = sqrt(2 / (Ns + 2)) (Walter et al. 2007, eq. 20); Ns absent: 1. What is not
/// metal has the index Ni if it is above 1, or the one of the reflectance Ks, or 1.5. map_Kd is multiplied by
/// Kd where that is not black. d (or 1 - Tr) times map_d is the opacity, except of dielectrics. map_bump and
/// bump are heights, their -bm in scene units; norm is a normal map. -s is the repeat, -o the offset and
/// -imfchan the channel; other options, Ka, map_Ks, map_Ns, disp and refl are ignored.
///
/// Adds to `warnings`, one line each as mtl_warning: numbers out of range, which are taken as the nearest in
/// it (an Ni below 1: as none), d -halo and colours as spectral or xyz, which are left out, images without a
/// file, and -clamp on.
///
/// Throws Error(bad_input), one line: a file that cannot be read; `FILE: line N: ...` for what should be
/// numbers and is not; `FILE: material 'M': ...` for an image that is not there or not readable.
std::vector<MtlMaterial> load_mtl(const std::string& path, const std::optional<std::set<std::string>>& wanted,
                                  Textures& textures, std::vector<std::string>& warnings);

/// The material of each part, in their order: from the material files that the OBJ names, relative to it.
/// Faces before any usemtl are white (0.8) and diffuse. Throws as load_mtl, and `OBJ: no material 'M' in ...`
/// for a part whose material no file has.
std::vector<MtlMaterial> load_part_materials(const std::string& obj_path, const ObjParts& obj,
                                             Textures& textures, std::vector<std::string>& warnings);

}  // namespace becalm::tracer
