"""Images and calibrations for the commands of the documents."""
import pathlib
import random
import struct
import zlib

WIDTH, HEIGHT = 640, 480  # of a board that has no calibration
DISPARITY = 12  # px
FOCAL, BASELINE = 500.0, 0.1  # px, m
BOARD, SQUARE = (9, 6), 0.025  # inner corners, m


def write_png(path, rows):
    """Writes rows of bytes as a grey image."""
    def chunk(kind, data):
        body = kind + data
        return struct.pack(">I", len(data)) + body + struct.pack(">I", zlib.crc32(body))
    header = struct.pack(">IIBBBBB", len(rows[0]), len(rows), 8, 0, 0, 0, 0)
    pixels = zlib.compress(b"".join(b"\0" + bytes(row) for row in rows))
    pathlib.Path(path).write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) +
                                   chunk(b"IDAT", pixels) + chunk(b"IEND", b""))


def noise_pair(width=WIDTH, height=HEIGHT, disparity=DISPARITY):
    """Returns the rows of a left and a right image with one disparity."""
    generator = random.Random(1)
    rows = [generator.randbytes(width + disparity) for _ in range(height)]
    # A left pixel is found `disparity` px to the left in the right image.
    return [r[:width] for r in rows], [r[disparity:disparity + width] for r in rows]


def camera_info(side, width=WIDTH, height=HEIGHT):
    """Returns the camera_info file of a rectified camera."""
    shift = 0.0 if side == "left" else -FOCAL * BASELINE
    k = [FOCAL, 0, width / 2, 0, FOCAL, height / 2, 0, 0, 1]
    p = [FOCAL, 0, width / 2, shift, 0, FOCAL, height / 2, 0, 0, 0, 1, 0]
    matrices = {"camera_matrix": (3, 3, k), "distortion_coefficients": (1, 5, [0] * 5),
                "rectification_matrix": (3, 3, [1, 0, 0, 0, 1, 0, 0, 0, 1]),
                "projection_matrix": (3, 4, p)}
    text = (f"image_width: {width}\nimage_height: {height}\ncamera_name: {side}\n"
            "distortion_model: plumb_bob\n")
    for name, (rows, columns, values) in matrices.items():
        text += f"{name}:\n  rows: {rows}\n  cols: {columns}\n  data: {[float(v) for v in values]}\n"
    return text


def chessboard(turn_x, turn_y, distance, camera_x, width=320, height=240, focal=300.0):
    """Returns the rows of a view of a chessboard that is turned about two axes (rad)."""
    from math import cos, sin
    (ca, sa), (cb, sb) = (cos(turn_x), sin(turn_x)), (cos(turn_y), sin(turn_y))
    right = (cb, sa * sb, -ca * sb)  # the axes of the board, as the camera sees them
    down = (0.0, ca, sa)
    normal = (sb, -sa * cb, ca * cb)
    columns, lines = BOARD[0] + 1, BOARD[1] + 1
    middle = (-camera_x, 0.0, distance)
    depth = sum(n * m for n, m in zip(normal, middle))

    def grey(x, y):
        ray = ((x - width / 2) / focal, (y - height / 2) / focal, 1.0)
        scale = depth / sum(n * r for n, r in zip(normal, ray))
        point = [scale * r - m for r, m in zip(ray, middle)]
        u = sum(a * p for a, p in zip(right, point)) / SQUARE + columns / 2
        v = sum(a * p for a, p in zip(down, point)) / SQUARE + lines / 2
        if 0 <= u < columns and 0 <= v < lines:
            return 20 if (int(u) + int(v)) % 2 == 0 else 235
        return 235

    offsets = (0.25, -0.25)
    return [[sum(grey(x + i, y + j) for i in offsets for j in offsets) // 4 for x in range(width)]
            for y in range(height)]


def write_chessboards(folder):
    """Writes left01.jpg, right01.jpg, ... (PNG files, which OpenCV recognises)."""
    poses = [(0.3, 0, 0.5), (-0.3, 0.2, 0.45), (0, 0.4, 0.5), (0.25, -0.4, 0.5), (0.3, 0.3, 0.55),
             (-0.2, -0.3, 0.45)]
    for number, (turn_x, turn_y, distance) in enumerate(poses, 1):
        for side, camera_x in (("left", -0.02), ("right", 0.02)):
            write_png(folder / f"{side}{number:02}.jpg",
                      chessboard(turn_x, turn_y, distance, camera_x))


def write_opencv_calibration(folder):
    """Writes intrinsics.yml and extrinsics.yml of the chessboards' cameras."""
    def matrix(name, rows, columns, values):
        return (f"{name}: !!opencv-matrix\n   rows: {rows}\n   cols: {columns}\n   dt: d\n"
                f"   data: {[float(v) for v in values]}\n")
    camera = [300, 0, 160, 0, 300, 120, 0, 0, 1]
    text = "".join(matrix(f"M{i}", 3, 3, camera) + matrix(f"D{i}", 1, 5, [0] * 5) for i in (1, 2))
    (folder / "intrinsics.yml").write_text("%YAML:1.0\n---\n" + text, encoding="utf-8")
    turn = [1, 0, 0, 0, 1, 0, 0, 0, 1]
    text = matrix("R", 3, 3, turn) + matrix("T", 3, 1, [-0.04, 0, 0])
    for i, shift in ((1, 0), (2, -12)):
        text += matrix(f"R{i}", 3, 3, turn)
        text += matrix(f"P{i}", 3, 4, [300, 0, 160, shift, 0, 300, 120, 0, 0, 0, 1, 0])
    (folder / "extrinsics.yml").write_text("%YAML:1.0\n---\n" + text, encoding="utf-8")


def write_middlebury(folder):
    """Writes four scenes with known disparities in the layout of Middlebury v2."""
    for scene, units in (("tsukuba", 16), ("venus", 8), ("teddy", 4), ("cones", 4)):
        at = folder / scene
        at.mkdir(parents=True)
        left, right = noise_pair(160, 60, 8)
        write_png(at / "imL.png", left)
        write_png(at / "imR.png", right)
        write_png(at / "groundtruth.png", [[8 * units] * 160] * 60)
        for mask in ("nonocc", "all", "disc"):
            write_png(at / f"{mask}.png", [[255] * 160] * 60)


def write_all(folder):
    """Writes everything that the commands read, apart from bags."""
    left, right = noise_pair()
    for side, rows in (("left", left), ("right", right)):
        write_png(folder / f"{side}.png", rows)
        (folder / f"{side}.yaml").write_text(camera_info(side), encoding="utf-8")
        (folder / side).mkdir()
        for number in range(3):
            write_png(folder / side / f"{number}.png", rows)
    write_chessboards(folder)
    (folder / "chessboards").mkdir()
    write_opencv_calibration(folder / "chessboards")
    for image in folder.glob("*.jpg"):
        (folder / "chessboards" / image.name).symlink_to(f"../{image.name}")
    write_middlebury(folder / "middlebury")
