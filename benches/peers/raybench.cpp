// raybench.cpp - raw ray queries against an Embree library (3.x or 4.x), chosen at run time.
//
//   g++ -O3 -march=native -o raybench raybench.cpp -ldl
//   ./raybench EMBREE.so WHAT [quality=medium|high] [repeats=5]
//     WHAT = spheres:N | icos:N:LEVEL | obj:FILE
//
// One CSV line per measurement on stdout: library,what,quality,measure,value,unit,hits,sum_t,xor_id
// The geometry and the rays are those of docs/stress.md ("Ray-query benchmark").
// Types come from the Embree 3 header; Embree 4 keeps their layout (its hit record may be one
// word longer, hence the padding below) and only changes how queries are called.
#include <embree3/rtcore.h>
#include <dlfcn.h>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <map>
#include <string>
#include <vector>
typedef std::chrono::steady_clock Clock;
static double since(Clock::time_point t){ return std::chrono::duration<double>(Clock::now()-t).count(); }
// queries run on one thread and are timed by that thread's CPU clock, which other programs on the machine disturb less
static double cpu(){ timespec t; clock_gettime(CLOCK_THREAD_CPUTIME_ID,&t); return t.tv_sec+1e-9*t.tv_nsec; }

// ---- the library -------------------------------------------------------------------------
static void* lib; static int major;
template<class F> static F sym(const char*n){ void*p=dlsym(lib,n); if(!p){fprintf(stderr,"no %s\n",n);exit(1);} return (F)p; }
#define L(name) static auto name##_=sym<decltype(&name)>(#name)
struct Args4 { int flags; unsigned feature_mask; void* context; void* filter; void* fn; float minw; };   // Embree 4 RTCIntersect/OccludedArguments
static Args4 args4(bool coherent){ return Args4{coherent?1<<16:0, 0xffffffffu, nullptr, nullptr, nullptr, 0}; }
static RTCIntersectContext ctx3(bool coherent){ RTCIntersectContext c; rtcInitIntersectContext(&c); c.flags=coherent?RTC_INTERSECT_CONTEXT_FLAG_COHERENT:RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT; return c; }
typedef void (*Q3)(RTCScene,RTCIntersectContext*,void*);  typedef void (*Q4)(RTCScene,void*,Args4*);
typedef void (*P3)(const int*,RTCScene,RTCIntersectContext*,void*);  typedef void (*P4)(const int*,RTCScene,void*,Args4*);

// ---- geometry ----------------------------------------------------------------------------
struct F3 { float x,y,z; };
static uint64_t sm(uint64_t&s){ uint64_t z=(s+=0x9E3779B97F4A7C15ull); z=(z^(z>>30))*0xBF58476D1CE4E5B9ull; z=(z^(z>>27))*0x94D049BB133111EBull; return z^(z>>31); }
static double uni(uint64_t&s){ return (double)(sm(s)>>11)*0x1p-53; }
static const double LO[3]={-40,-14,-190}, HI[3]={40,40,-60};
static std::vector<F3> centres(int n,float&r){ uint64_t s=1; std::vector<F3> c(n); for(auto&p:c){ p.x=(float)(LO[0]+(HI[0]-LO[0])*uni(s)); p.y=(float)(LO[1]+(HI[1]-LO[1])*uni(s)); p.z=(float)(LO[2]+(HI[2]-LO[2])*uni(s)); uni(s);} r=(float)(1.35*std::sqrt(1000.0/n)); return c; }
struct D3 { double x,y,z; };
static void icosphere(int level,std::vector<D3>&v,std::vector<int>&f){   // 10*4^level+2 vertices, 20*4^level triangles
  double g=(1+std::sqrt(5.0))/2; v={{-1,g,0},{1,g,0},{-1,-g,0},{1,-g,0},{0,-1,g},{0,1,g},{0,-1,-g},{0,1,-g},{g,0,-1},{g,0,1},{-g,0,-1},{-g,0,1}};
  auto nrm=[](D3 a){double l=std::sqrt(a.x*a.x+a.y*a.y+a.z*a.z);return D3{a.x/l,a.y/l,a.z/l};}; for(auto&p:v)p=nrm(p);
  f={0,11,5, 0,5,1, 0,1,7, 0,7,10, 0,10,11, 1,5,9, 5,11,4, 11,10,2, 10,7,6, 7,1,8, 3,9,4, 3,4,2, 3,2,6, 3,6,8, 3,8,9, 4,9,5, 2,4,11, 6,2,10, 8,6,7, 9,8,1};
  for(int l=0;l<level;l++){ std::map<std::pair<int,int>,int> mid; std::vector<int> h; auto m=[&](int a,int b){ auto k=std::minmax(a,b); auto it=mid.find(k); if(it!=mid.end())return it->second; D3 p=v[a],q=v[b]; v.push_back(nrm({(p.x+q.x)/2,(p.y+q.y)/2,(p.z+q.z)/2})); return mid[k]=(int)v.size()-1; };
    for(size_t t=0;t<f.size();t+=3){ int a=f[t],b=f[t+1],c=f[t+2],ab=m(a,b),bc=m(b,c),ca=m(c,a); for(int x:{a,ab,ca, b,bc,ab, c,ca,bc, ab,bc,ca}) h.push_back(x);} f=h; } }
struct Geo { bool spheres=false; std::vector<float> v; std::vector<unsigned> i; float lo[3],hi[3]; size_t prims=0; };
static Geo make(const std::string&w){ Geo g; for(int k=0;k<3;k++){g.lo[k]=(float)LO[k];g.hi[k]=(float)HI[k];}
  if(w.rfind("spheres:",0)==0){ float r; auto c=centres((int)atof(w.c_str()+8),r); g.spheres=true; g.prims=c.size(); for(auto&p:c){g.v.insert(g.v.end(),{p.x,p.y,p.z,r});} }
  else if(w.rfind("icos:",0)==0){ int n=(int)atof(w.c_str()+5), lev=atoi(w.c_str()+w.rfind(':')+1); float r; auto c=centres(n,r); std::vector<D3>v;std::vector<int>f; icosphere(lev,v,f);
    for(size_t s=0;s<c.size();s++){ for(auto&p:v) g.v.insert(g.v.end(),{(float)(c[s].x+r*p.x),(float)(c[s].y+r*p.y),(float)(c[s].z+r*p.z)}); for(int k:f) g.i.push_back((unsigned)(s*v.size()+k)); } g.prims=g.i.size()/3; }
  else { FILE*fp=fopen(w.c_str()+4,"r"); if(!fp){perror(w.c_str());exit(1);} char b[512]; std::vector<double> dv; while(fgets(b,sizeof b,fp)){ double x,y,z; if(sscanf(b,"v %lf %lf %lf",&x,&y,&z)==3)dv.insert(dv.end(),{x,y,z}); else if(b[0]=='f'){ std::vector<unsigned> c; for(char*p=strtok(b+1," \t\r\n");p;p=strtok(nullptr," \t\r\n")) c.push_back((unsigned)atoi(p)-1); for(size_t k=2;k<c.size();k++) g.i.insert(g.i.end(),{c[0],c[k-1],c[k]}); } } fclose(fp); g.prims=g.i.size()/3;
    double lo[3],hi[3],side=0; for(int k=0;k<3;k++){ lo[k]=1e300;hi[k]=-1e300; for(size_t t=k;t<dv.size();t+=3){lo[k]=std::min(lo[k],dv[t]);hi[k]=std::max(hi[k],dv[t]);} side=std::max(side,hi[k]-lo[k]); }   // fit: box centred on (0,0,-100), largest side 40
    for(size_t t=0;t<dv.size();t++) g.v.push_back((float)((dv[t]-(lo[t%3]+hi[t%3])/2)*(40/side)+(t%3==2?-100:0)));
    for(int k=0;k<3;k++){ float a=1e30f,c=-1e30f; for(size_t t=k;t<g.v.size();t+=3){a=std::min(a,g.v[t]);c=std::max(c,g.v[t]);} g.lo[k]=a; g.hi[k]=c; } }
  return g; }

// ---- rays --------------------------------------------------------------------------------
struct Ray { float o[3],d[3],t0,t1; };
static const int W=600;
static Ray camera(int i,int j){ double x=-10+20*(i+.5)/W, y=10-20*(j+.5)/W, z=-40, l=std::sqrt(x*x+y*y+z*z); return Ray{{0,0,0},{(float)(x/l),(float)(y/l),(float)(z/l)},0,INFINITY}; }
static void put(RTCRayHit&h,const Ray&r){ h.ray.org_x=r.o[0];h.ray.org_y=r.o[1];h.ray.org_z=r.o[2];h.ray.dir_x=r.d[0];h.ray.dir_y=r.d[1];h.ray.dir_z=r.d[2];h.ray.tnear=r.t0;h.ray.tfar=r.t1;h.ray.time=0;h.ray.mask=~0u;h.ray.id=0;h.ray.flags=0;h.hit.geomID=h.hit.primID=h.hit.instID[0]=RTC_INVALID_GEOMETRY_ID; }
struct Sum { long hits=0; double t=0; unsigned x=0; };
int main(int ac,char**av){
  if(ac<3){fprintf(stderr,"usage: raybench EMBREE.so spheres:N|icos:N:LEVEL|obj:FILE [medium|high|medium-robust] [repeats]\n");return 1;}
  lib=dlopen(av[1],RTLD_NOW|RTLD_LOCAL); if(!lib){fprintf(stderr,"%s\n",dlerror());return 1;}
  std::string what=av[2], quality=ac>3?av[3]:"medium"; int rep=ac>4?atoi(av[4]):5;
  L(rtcNewDevice);L(rtcReleaseDevice);L(rtcGetDeviceProperty);L(rtcNewScene);L(rtcReleaseScene);L(rtcNewGeometry);L(rtcReleaseGeometry);L(rtcSetNewGeometryBuffer);L(rtcCommitGeometry);L(rtcAttachGeometry);L(rtcCommitScene);L(rtcSetSceneBuildQuality);L(rtcSetSceneFlags);
  Geo g=make(what); std::string shown=what.rfind("obj:",0)==0?"obj:"+std::to_string(g.prims)+":"+what.substr(what.rfind('/')+1):what; std::string name;
  auto out=[&](const char*m,double v,const char*u,Sum s){ printf("%s,%s,%s,%s,%.6g,%s,%ld,%.9g,%08x\n",name.c_str(),shown.c_str(),quality.c_str(),m,v,u,s.hits,s.t,s.x); fflush(stdout); };
  auto build=[&](RTCDevice dev,double&best)->RTCScene{ RTCScene sc=rtcNewScene_(dev); rtcSetSceneBuildQuality_(sc,quality.find("high")==0?RTC_BUILD_QUALITY_HIGH:RTC_BUILD_QUALITY_MEDIUM); if(quality.find("robust")!=std::string::npos) rtcSetSceneFlags_(sc,RTC_SCENE_FLAG_ROBUST); RTCGeometry ge;
    if(g.spheres){ ge=rtcNewGeometry_(dev,RTC_GEOMETRY_TYPE_SPHERE_POINT); memcpy(rtcSetNewGeometryBuffer_(ge,RTC_BUFFER_TYPE_VERTEX,0,RTC_FORMAT_FLOAT4,16,g.prims),g.v.data(),g.v.size()*4); }
    else { ge=rtcNewGeometry_(dev,RTC_GEOMETRY_TYPE_TRIANGLE); memcpy(rtcSetNewGeometryBuffer_(ge,RTC_BUFFER_TYPE_VERTEX,0,RTC_FORMAT_FLOAT3,12,g.v.size()/3),g.v.data(),g.v.size()*4); memcpy(rtcSetNewGeometryBuffer_(ge,RTC_BUFFER_TYPE_INDEX,0,RTC_FORMAT_UINT3,12,g.prims),g.i.data(),g.i.size()*4); }
    auto t=Clock::now(); rtcCommitGeometry_(ge); rtcAttachGeometry_(sc,ge); rtcReleaseGeometry_(ge); rtcCommitScene_(sc); best=std::min(best,since(t)); return sc; };
  RTCScene sc=nullptr; RTCDevice dev=nullptr;
  for(int th:{2,1}){ dev=rtcNewDevice_(th==1?"threads=1":"threads=2"); if(name.empty()){ int v=(int)rtcGetDeviceProperty_(dev,RTC_DEVICE_PROPERTY_VERSION); major=v/10000; name="embree-"+std::to_string(v/10000)+"."+std::to_string(v/100%100)+"."+std::to_string(v%100); }
    double best=1e300; int n=g.prims>500000?3:rep; for(int k=0;k<n;k++){ if(sc)rtcReleaseScene_(sc); sc=build(dev,best); }
    out(th==1?"build_1thread":"build_2threads",best*1e3,"ms",{(long)g.prims,0,0}); if(th==2){rtcReleaseScene_(sc);sc=nullptr;rtcReleaseDevice_(dev);} }
  void*i1=dlsym(lib,"rtcIntersect1"),*o1=dlsym(lib,"rtcOccluded1"),*i8=dlsym(lib,"rtcIntersect8"),*i16=dlsym(lib,"rtcIntersect16");
  struct alignas(64) RH:RTCRayHit{ unsigned pad[16]; };
  auto isect=[&](const std::vector<Ray>&r,std::vector<float>*ts,Sum&s)->double{ RTCIntersectContext c3=ctx3(false); Args4 a4=args4(false); s=Sum(); RH h; double t=cpu();
    for(size_t k=0;k<r.size();k++){ put(h,r[k]); if(major==3)((Q3)i1)(sc,&c3,&h); else ((Q4)i1)(sc,&h,&a4); bool hit=h.hit.geomID!=RTC_INVALID_GEOMETRY_ID; if(hit){s.hits++;s.t+=h.ray.tfar;s.x^=h.hit.primID*2654435761u;} if(ts)(*ts)[k]=hit?h.ray.tfar:-1; } return cpu()-t; };
  auto mrays=[&](const char*m,size_t n,auto&&fn){ double best=1e300; Sum s; for(int k=0;k<rep;k++)best=std::min(best,fn(s)); out(m,n/best*1e-6,"Mrays/s",s); };
  std::vector<Ray> cam; for(int j=0;j<W;j++)for(int i=0;i<W;i++)cam.push_back(camera(i,j));
  std::vector<float> ts(cam.size()); { Sum s; isect(cam,&ts,s); }
  mrays("camera_intersect1",cam.size(),[&](Sum&s){return isect(cam,nullptr,s);});
  auto packet=[&](auto*tag,int N,int tw,int th,void*fn,bool coh,Sum&s)->double{ typedef std::remove_pointer_t<decltype(tag)> P; struct alignas(64) PP:P{ unsigned pad[32]; }; PP h; alignas(64) int valid[16]; for(int&v:valid)v=-1; RTCIntersectContext c3=ctx3(coh); Args4 a4=args4(coh); s=Sum(); double t=cpu();
    for(int j=0;j<W;j+=th)for(int i=0;i<W;i+=tw){ for(int k=0;k<N;k++){ const Ray&r=cam[(j+k/tw)*W+i+k%tw]; h.ray.org_x[k]=r.o[0];h.ray.org_y[k]=r.o[1];h.ray.org_z[k]=r.o[2];h.ray.dir_x[k]=r.d[0];h.ray.dir_y[k]=r.d[1];h.ray.dir_z[k]=r.d[2];h.ray.tnear[k]=0;h.ray.tfar[k]=INFINITY;h.ray.time[k]=0;h.ray.mask[k]=~0u;h.ray.id[k]=0;h.ray.flags[k]=0;h.hit.geomID[k]=h.hit.primID[k]=h.hit.instID[0][k]=RTC_INVALID_GEOMETRY_ID; }
      if(major==3)((P3)fn)(valid,sc,&c3,&h); else ((P4)fn)(valid,sc,&h,&a4); for(int k=0;k<N;k++) if(h.hit.geomID[k]!=RTC_INVALID_GEOMETRY_ID){s.hits++;s.t+=h.ray.tfar[k];s.x^=h.hit.primID[k]*2654435761u;} } return cpu()-t; };
  mrays("camera_intersect8",cam.size(),[&](Sum&s){return packet((RTCRayHit8*)0,8,4,2,i8,false,s);});
  mrays("camera_intersect8_coherent",cam.size(),[&](Sum&s){return packet((RTCRayHit8*)0,8,4,2,i8,true,s);});
  mrays("camera_intersect16",cam.size(),[&](Sum&s){return packet((RTCRayHit16*)0,16,4,4,i16,false,s);});
  mrays("camera_intersect16_coherent",cam.size(),[&](Sum&s){return packet((RTCRayHit16*)0,16,4,4,i16,true,s);});
  std::vector<Ray> sh; const double LP[3]={30,40,-10}; for(size_t k=0;k<cam.size();k++) if(ts[k]>=0){ Ray r; double v[3],l=0; for(int a=0;a<3;a++){ r.o[a]=cam[k].o[a]+ts[k]*cam[k].d[a]; v[a]=LP[a]-r.o[a]; l+=v[a]*v[a]; } l=std::sqrt(l); for(int a=0;a<3;a++) r.d[a]=(float)(v[a]/l); r.t0=1e-3f; r.t1=(float)(l-1e-3); sh.push_back(r); }
  mrays("shadow_occluded1",sh.size(),[&](Sum&s)->double{ RTCIntersectContext c3=ctx3(false); Args4 a4=args4(false); s=Sum(); RH h; double t=cpu(); for(auto&r:sh){ put(h,r); if(major==3)((Q3)o1)(sc,&c3,&h.ray); else ((Q4)o1)(sc,&h.ray,&a4); if(h.ray.tfar<0)s.hits++; } return cpu()-t; });
  std::vector<Ray> rnd(1000000); uint64_t s7=7; for(auto&r:rnd){ for(int a=0;a<3;a++) r.o[a]=(float)(g.lo[a]+((double)g.hi[a]-g.lo[a])*uni(s7)); double z=2*uni(s7)-1, p=2*M_PI*uni(s7), q=std::sqrt(1-z*z); r.d[0]=(float)(q*std::cos(p)); r.d[1]=(float)(q*std::sin(p)); r.d[2]=(float)z; r.t0=0; r.t1=INFINITY; }
  mrays("random_intersect1",rnd.size(),[&](Sum&s){return isect(rnd,nullptr,s);});
}
