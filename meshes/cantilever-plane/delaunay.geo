// Plane beam 1 x 0.1 m along x, centred on y = 0, in triangles by Delaunay. Lengths in metres.
SetFactory("OpenCASCADE");

DefineConstant[
  depth = 4          // elements through the depth
];

Rectangle(1) = {0, -0.05, 0, 1, 0.1};

Physical Surface("beam") = {1};
Physical Curve("clamp") = {4};
Physical Curve("tip") = {2};

Mesh.MeshSizeMin = 0.1 / depth;
Mesh.MeshSizeMax = 0.1 / depth;
Mesh.Algorithm = 5;
Mesh.Optimize = 1;
