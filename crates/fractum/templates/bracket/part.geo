// An L-shaped bracket of two legs of 60 mm, 12 mm thick and 20 mm wide, its inner corner an arc of 6 mm, in mm: gmsh part.geo -3
SetFactory("OpenCASCADE");
h = 3;                                    // size of elements
Box(1) = {0, 0, 0, 12, 60, 20};           // standing leg
Box(2) = {12, 0, 0, 48, 12, 20};          // lying leg
Box(3) = {12, 12, 0, 6, 6, 20};           // inner corner
Cylinder(4) = {18, 18, 0, 0, 0, 20, 6};
BooleanDifference(5) = { Volume{3}; Delete; }{ Volume{4}; Delete; };
BooleanUnion(6) = { Volume{1}; Delete; }{ Volume{2, 5}; Delete; };
Physical Volume("bracket") = {6};
Physical Surface("top") = Surface In BoundingBox {-1, 59, -1, 13, 61, 21};
Physical Surface("end") = Surface In BoundingBox {59, -1, -1, 61, 13, 21};
Mesh.MeshSizeMax = h; Mesh.MeshSizeMin = h;
