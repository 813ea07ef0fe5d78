"""stress.py - the sphere stress scene of docs/stress.md.

    python3 stress.py pov     N OUT.pov       POV-Ray 3.7 scene
    python3 stress.py mitsuba N OUT.xml       Mitsuba 3 scene (its own light transport, so pictures differ)
    python3 stress.py raw     N OUT.bin       N records x, y, z (float32 LE), then N bytes of material
    python3 stress.py check   N               checksums, to verify another generator

Needs numpy only.
"""
import sys, zlib
import numpy as np

GAMMA = np.uint64(0x9E3779B97F4A7C15)
M1, M2 = np.uint64(0xBF58476D1CE4E5B9), np.uint64(0x94D049BB133111EB)
SEED = 1
LO, HI = np.array([-40., -14., -190.]), np.array([40., 40., -60.])
PALETTE = [(.90,.25,.20),(.95,.55,.15),(.95,.80,.20),(.70,.85,.25),(.30,.75,.35),(.20,.70,.60),(.25,.70,.90),(.20,.45,.90),
           (.40,.35,.85),(.65,.35,.85),(.90,.40,.75),(.95,.60,.65),(.75,.55,.40),(.95,.90,.80),(.60,.65,.70),(.35,.40,.45)]
MIRROR, GLASS = 16, 17

def splitmix(seed, n):
    """n 64-bit outputs of SplitMix64 started at seed."""
    with np.errstate(over='ignore'):
        z = np.uint64(seed) + GAMMA * np.arange(1, n + 1, dtype=np.uint64)
        z = (z ^ (z >> np.uint64(30))) * M1
        z = (z ^ (z >> np.uint64(27))) * M2
        return z ^ (z >> np.uint64(31))

def uniform(seed, n):
    return (splitmix(seed, n) >> np.uint64(11)).astype(np.float64) * 2.0**-53

def spheres(n, seed=SEED):
    u = uniform(seed, 4 * n).reshape(n, 4)
    pos = (LO + (HI - LO) * u[:, :3]).astype(np.float32)
    k = np.floor(100 * u[:, 3]).astype(np.int64)
    mat = np.where(k < 80, k % 16, np.where(k < 95, MIRROR, GLASS)).astype(np.uint8)
    radius = np.float32(1.35 * np.sqrt(1000.0 / n))
    return pos, mat, radius

def pov(n, out):
    pos, mat, r = spheres(n)
    w = out.write
    w('''// %d spheres, seed %d - written by stress.py (docs/stress.md)
#version 3.7;
global_settings { assumed_gamma 1 max_trace_level 6 adc_bailout 0 ambient_light 1 }
camera { perspective location 0 direction <0,0,-40> right <20,0,0> up <0,20,0> }
background { srgb <0.62, 0.76, 0.92> }
light_source { <  30, 40, -10> rgb 0.45 }
light_source { < -55, 30, -45> rgb 0.75 }
polygon { 5, <-50,-15,-40>, <50,-15,-40>, <50,-15,-200>, <-50,-15,-200>, <-50,-15,-40>
  texture { pigment { checker srgb <0.95,0.92,0.84> srgb <0.36,0.60,0.60> scale 5 translate 2.5 } finish { ambient 0.2 diffuse 0.8 } } }
''' % (n, SEED))
    for i, c in enumerate(PALETTE):
        w('#declare T%d = texture { pigment { srgb <%g,%g,%g> } finish { ambient 0.2 diffuse 0.8 phong 0 } }\n' % ((i,) + c))
    w('''#declare T16 = texture { pigment { srgb <0.25,0.25,0.30> } finish { ambient 0.2 diffuse 0.8 phong 1 phong_size 80 reflection { 0.8 } } }
#declare T17 = texture { pigment { rgbt <1,1,1,0.85> } finish { ambient 0 diffuse 0 phong 1 phong_size 100 reflection { 0.1 } } }
#declare T18 = texture { pigment { rgbt <1,1,1,0.85> } finish { ambient 0 diffuse 0 } }
#declare I17 = interior { ior 1.5 }
#declare R = %.9g;
''' % r)
    for (x, y, z), m in zip(pos.tolist(), mat.tolist()):
        if m == GLASS:
            w('sphere{<%.9g,%.9g,%.9g>,R texture{T17} interior_texture{T18} interior{I17}}\n' % (x, y, z))
        else:
            w('sphere{<%.9g,%.9g,%.9g>,R texture{T%d}}\n' % (x, y, z, m))

def mitsuba(n, out, integrator='path'):
    pos, mat, r = spheres(n)
    w = out.write
    w('''<scene version="3.0.0">
<default name="spp" value="1"/><default name="depth" value="6"/>
<integrator type="%s"><integer name="max_depth" value="$depth"/><integer name="rr_depth" value="100"/></integrator>
<sensor type="perspective"><float name="fov" value="28.072486935852957"/><string name="fov_axis" value="x"/>
 <transform name="to_world"><lookat origin="0,0,0" target="0,0,-1" up="0,1,0"/></transform>
 <sampler type="independent"><integer name="sample_count" value="$spp"/></sampler>
 <film type="hdrfilm"><integer name="width" value="600"/><integer name="height" value="600"/><rfilter type="box"/></film></sensor>
<emitter type="constant"><rgb name="radiance" value="0.25"/></emitter>
<emitter type="point"><point name="position" x="30" y="40" z="-10"/><rgb name="intensity" value="18000"/></emitter>
<emitter type="point"><point name="position" x="-55" y="30" z="-45"/><rgb name="intensity" value="24000"/></emitter>
<bsdf type="twosided" id="floor"><bsdf type="diffuse"><texture type="checkerboard" name="reflectance"><rgb name="color0" value="0.89,0.83,0.67"/><rgb name="color1" value="0.11,0.32,0.32"/>
 <transform name="to_uv"><scale x="10" y="16"/></transform></texture></bsdf></bsdf>
<shape type="rectangle"><transform name="to_world"><scale x="50" y="80"/><rotate x="1" angle="-90"/><translate x="0" y="-15" z="-120"/></transform><ref id="floor"/></shape>
''' % integrator)
    dec = lambda c: c / 12.92 if c <= .04045 else ((c + .055) / 1.055) ** 2.4
    for i, c in enumerate(PALETTE):
        w('<bsdf type="diffuse" id="m%d"><rgb name="reflectance" value="%g,%g,%g"/></bsdf>\n' % ((i,) + tuple(map(dec, c))))
    w('<bsdf type="conductor" id="m16"><rgb name="specular_reflectance" value="0.8"/></bsdf>\n')
    w('<bsdf type="dielectric" id="m17"><float name="int_ior" value="1.5"/><float name="ext_ior" value="1.0"/></bsdf>\n')
    for (x, y, z), m in zip(pos.tolist(), mat.tolist()):
        w('<shape type="sphere"><point name="center" x="%.9g" y="%.9g" z="%.9g"/><float name="radius" value="%.9g"/><ref id="m%d"/></shape>\n' % (x, y, z, r, m))
    w('</scene>\n')

def check(n):
    pos, mat, r = spheres(n)
    print(f"N {n}  radius {r:.9g}  matte {(mat<16).sum()} mirror {(mat==16).sum()} glass {(mat==17).sum()}")
    print(f"  CRC-32 positions {zlib.crc32(pos.astype('<f4').tobytes()):08x}  materials {zlib.crc32(mat.tobytes()):08x}")
    for i in (0, 1, n - 1):
        print(f"  sphere {i}: {pos[i,0]:.9g} {pos[i,1]:.9g} {pos[i,2]:.9g} material {mat[i]}")

if __name__ == '__main__':
    kind, n = sys.argv[1], int(float(sys.argv[2]))
    if kind == 'check':
        print("SplitMix64(1):", ' '.join(f"{int(v):016x}" for v in splitmix(1, 4)))
        check(n)
    elif kind == 'raw':
        pos, mat, r = spheres(n)
        with open(sys.argv[3], 'wb') as f:
            f.write(pos.astype('<f4').tobytes()); f.write(mat.tobytes())
    else:
        with open(sys.argv[3], 'w') as f:
            {'pov': pov, 'mitsuba': mitsuba}[kind](n, f)
