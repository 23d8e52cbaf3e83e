// Brick L x W x H, turned about y and lifted so that its lowest edge is `gap` above the plane z = 0. Lengths in metres.
SetFactory("OpenCASCADE");

DefineConstant[
  L = 0.2            // along x before turning
  W = 0.1            // along y
  H = 0.1            // along z before turning
  tilt = 20          // degrees about y; positive lowers the end x > 0
  gap = 0.001        // between the lowest edge and z = 0
  h = 0.0162         // element size
  inner = 0.25       // Delaunay makes inner elements about 1/4 larger than asked: ask for that much less inside
];

Box(1) = {-L/2, -W/2, -H/2, L, W, H};
a = tilt*Pi/180;
Rotate { {0, 1, 0}, {0, 0, 0}, a } { Volume{1}; }
Translate {0, 0, gap + L/2*Sin(a) + H/2*Cos(a)} { Volume{1}; }
all() = Boundary { Volume{1}; };

Physical Volume("block") = {1};

Field[1] = Distance;
Field[1].SurfacesList = {all()};
Field[1].Sampling = 60;
Field[2] = MathEval;
Field[2].F = Sprintf("%g*(1 - %g*min(1, F1/%g))", h, inner, h);
Background Field = 2;

Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
Mesh.Algorithm = 6;
Mesh.Algorithm3D = 1;
Mesh.Optimize = 1;
Mesh.OptimizeNetgen = 1;
