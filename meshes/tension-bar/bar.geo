// Bar L x H x H along x, centred on the origin, unstructured. Lengths in metres.
SetFactory("OpenCASCADE");

DefineConstant[
  L = 0.1            // length
  H = 0.02           // depth and width
  h = 0.004          // element size
  inner = 0.25       // Delaunay makes inner elements about 1/4 larger than asked: ask for that much less inside
];

Box(1) = {-L/2, -H/2, -H/2, L, H, H};
e = H/1000;
left() = Surface In BoundingBox {-L/2 - e, -H, -H, -L/2 + e, H, H};
right() = Surface In BoundingBox {L/2 - e, -H, -H, L/2 + e, H, H};
all() = Boundary { Volume{1}; };

Physical Volume("bar") = {1};
Physical Surface("left") = {left()};
Physical Surface("right") = {right()};

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
