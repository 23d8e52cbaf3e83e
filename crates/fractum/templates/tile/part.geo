// A tile of 200 x 200 x 30 mm, in mm: gmsh part.geo -3
SetFactory("OpenCASCADE");
Box(1) = {-100, -100, 0, 200, 200, 30};
Physical Volume("tile") = {1};
Mesh.MeshSizeMax = 8; Mesh.MeshSizeMin = 8;
