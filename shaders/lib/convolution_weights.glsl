// Weights of the convolutions of smooth/. Not pure functions: the including kernel defines kTaps, `p`
// (ConvolveParams) and the texel buffer `weights`. A pass convolves `planes` planes of its source. A
// workgroup makes the kPlanesMade planes of the result that gl_WorkGroupID.z selects. Its weights are
// contiguous: a bias for each of these planes, then kWeights more. They are copied to shared memory and read
// there at literal offsets, outside of all branches and loops: only then does lavapipe load each of them once
// for all lanes. A loop over the planes would take a hundred times as long.

layout(constant_id = 0) const int planes = 4;

layout(local_size_x = 32, local_size_y = 4) in;

const int kInvocations = 32 * 4;
const int kWeights = planes * 4 * kTaps * kPlanesMade;

shared vec4 shared_weights[kPlanesMade + kWeights];

void load_weights() {
  const int first = p.first_weight + int(gl_WorkGroupID.z) * (kPlanesMade + kWeights);
  for (int i = int(gl_LocalInvocationIndex); i < kPlanesMade + kWeights; i += kInvocations) {
    shared_weights[i] = texelFetch(weights, first + i);
  }
  barrier();
}

/// Weights from one channel of the pass's source, at one tap, to the four channels of a plane of the result.
vec4 weight_of(int channel, int tap, int plane_out) {
  return shared_weights[kPlanesMade + (channel * kTaps + tap) * kPlanesMade + plane_out];
}

/// The first of the kPlanesMade planes of the result that this workgroup makes.
int first_output() { return int(gl_WorkGroupID.z) * kPlanesMade; }

vec4 finished(vec4 sum) { return p.rectify != 0 ? max(sum, 0.0) : sum; }
