//! The table: each of the window's words, in English and in Simplified Chinese.

/// Makes the words and their table from one list.
macro_rules! table {
    ($($name:ident: $english:literal, $chinese:literal;)*) => {
        /// A word or a sentence of the window.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[allow(missing_docs, reason = "each is explained by the words themselves, below")]
        pub enum Text { $($name),* }

        impl Text {
            /// All of them.
            pub const ALL: &'static [Self] = &[$(Self::$name),*];

            /// The word in each language.
            pub(super) fn entry(self) -> [&'static str; 2] {
                match self { $(Self::$name => [$english, $chinese]),* }
            }
        }
    };
}

table! {
    // Things of the window.
    Stage: "Stage", "舞台";
    Gallery: "Experiments", "实验";
    GalleryTitle: "Choose an experiment", "选择一个实验";
    Charts: "Charts", "图表";
    Checks: "Checks", "检验";
    Honesty: "Honesty", "诚实";
    Notebook: "Notebook", "记录本";
    Help: "Keys", "按键";
    Timeline: "Timeline", "时间轴";
    Colours: "Colours", "配色";
    LanguageOf: "Language", "语言";
    ThemeDark: "Dark", "深色";
    ThemeLight: "Light", "浅色";
    ThemeProjector: "Projector", "投影";
    ToolHand: "Hand: move the view, follow a body", "手：移动视图、跟随粒子";
    ToolCarry: "Carry: drag a body to another place", "搬动：把粒子拖到别处";
    ToolThrow: "Throw: drag a body's velocity; the arrow is its way in the next second", "抛掷：拖出粒子的速度；箭头是它下一秒走的路程";
    ToolAdd: "Add: click for a body at rest, drag for one that flies", "添加：单击放一个静止的粒子，拖动放一个飞行的粒子";
    ToolRemove: "Take away: click a body", "取走：单击一个粒子";
    ToolPartition: "Partition: click, or drag along it; particles make room", "隔板：单击，或沿隔板方向拖动；粒子会让出位置";
    ToolHeat: "Heat bath: click a wall", "热浴：单击器壁";
    ToolPiston: "Piston: drag its velocity", "活塞：拖出它的速度";
    ToolRuler: "Ruler: drag a distance", "直尺：拖动量距离";
    ToolProbe: "Probe: drag a region", "探测器：拖出一个区域";

    // What keys and buttons do.
    Play: "Play", "播放";
    Pause: "Pause", "暂停";
    DoTogglePlay: "Play or pause", "播放或暂停";
    DoStep: "One step", "单步";
    DoNextEvent: "To the next collision", "到下一次碰撞";
    DoReverse: "Reverse all velocities", "反转所有速度";
    DoDisturb: "Disturb velocities by ε", "以 ε 扰动速度";
    DoArrows: "Velocities as arrows", "用箭头显示速度";
    DoOpenPartitions: "Open all partitions", "打开所有隔板";
    DoFaster: "Faster", "加快";
    DoSlower: "Slower", "减慢";
    DoRestart: "From the start", "从头开始";
    DoNewSeed: "New seed", "新的随机种子";
    DoRemember: "Remember this moment", "记住此刻";
    DoPreviousMoment: "Back to the moment before", "回到前一个记住的时刻";
    DoNextMoment: "On to the next moment", "到下一个记住的时刻";
    DoFit: "Everything in view", "显示全部";
    DoZoomIn: "Nearer", "放大";
    DoZoomOut: "Farther", "缩小";
    DoNextPaint: "Colour the bodies otherwise", "更换粒子着色";
    DoNextTool: "Next tool", "下一个工具";
    DoStopwatch: "Stopwatch: start, stop, clear", "秒表：开始、停止、清零";
    DoRecordRow: "Record a row", "记录一行";
    DoPreviousExperiment: "Experiment before this", "前一个实验";
    DoNextExperiment: "Next experiment", "下一个实验";
    DoGallery: "Gallery of experiments", "实验陈列室";
    DoCharts: "Show charts", "显示图表";
    DoChecks: "Show checks against theory", "显示与理论的检验";
    DoHonesty: "Show numerical honesty", "显示数值诚实度";
    DoNotebook: "Show the notebook", "显示记录本";
    DoPanels: "Panels on or off", "显示或隐藏面板";
    DoOpen: "Open a scenario", "打开场景文件";
    DoSave: "Save the scenario", "保存场景文件";
    DoRecord: "Record a picture or a film", "录制图片或影片";
    DoPalette: "Next palette", "下一种配色";
    DoLanguage: "Next language", "下一种语言";
    DoLarger: "Larger text", "放大文字";
    DoSmaller: "Smaller text", "缩小文字";
    DoHelp: "This list", "本列表";
    DoClose: "Close what is open", "关闭打开的窗口";
    DoQuit: "Leave", "退出";
    HelpPointer: "Wheel: zoom about the pointer. Drag: move, or turn in space. Click: follow a body. Double click: everything in view.",
        "滚轮：以指针为中心缩放。拖动：平移，三维中为旋转。单击：跟随粒子。双击：显示全部。";

    // Time.
    Time: "Time t", "时间 t";
    Speed: "Speed", "速度";
    EachSecond: " / s", " / 秒";
    SpeedHelp: "Physical time that passes in a second. It changes how fast you watch, never what is computed.",
        "每秒钟经过的物理时间。它只改变观看的快慢，不改变计算结果。";
    Seed: "Seed", "种子";
    SeedHelp: "Seed of all random numbers: the same seed gives the same run, bit for bit.", "所有随机数的种子：相同的种子逐位重现同一次运行。";
    GoTo: "Go to a time", "前往时刻";
    GoToHelp: "Type a time to go there, back or forth.", "输入时刻即可前往，可前可后。";
    TimelineHelp: "Click to go to a time. Going back runs again from the start: the same bits.", "单击前往某一时刻。返回时从头重算：结果逐位相同。";
    Travelling: "on the way to t = {}: {} %", "正在前往 t = {}：{} %";
    TooSlow: "the engine reaches {} % of this speed", "引擎只能达到该速度的 {} %";
    Refused: "{}: expected {}", "{}：应为 {}";
    Failed: "the dynamics broke down: {}", "动力学计算中断：{}";
    Unable: "not in this experiment: expected {}", "此实验不支持：需要 {}";
    NoCollisions: "nothing collides here", "此处没有碰撞";

    // Parameters.
    GroupPreset: "Situation", "情形";
    GroupSystem: "System", "系统";
    GroupMeasurement: "Measurement", "测量";
    RestartNote: "A changed value starts the run again.", "修改数值会重新开始运行。";
    ResetTo: "Back to what it is by itself, {}", "恢复默认值 {}";
    NotUsed: "Without influence where {} is: {}", "当 {} 为“{}”时不起作用";
    Expected: "expected {}", "应为 {}";
    Range: "From {} to {}.", "从 {} 到 {}。";
    ListRange: "At most {} numbers from {} to {}.", "最多 {} 个数，从 {} 到 {}。";
    Automatic: "automatic", "自动";
    OwnSystem: "A system of your own", "自定义系统";
    OwnSystemNote: "This system is described by its scenario file:", "该系统由其场景文件描述：";

    // Charts and checks.
    Theory: "theory", "理论";
    MakeLarge: "Click to enlarge", "单击放大";
    SavePicture: "Save as a picture", "保存为图片";
    SaveCsv: "Save as CSV", "保存为 CSV";
    NoCharts: "Nothing has been measured yet.", "尚未测量任何量。";
    NoChecks: "Nothing has been measured yet.", "尚未测量任何量。";
    ChecksHold: "{} of {} checks hold", "{} / {} 项检验通过";
    ChecksEarly: "Measured so far; the verdict is due at t = {}.", "目前的测量结果；t = {} 时给出结论。";

    // Honesty.
    Engine: "Engine", "引擎";
    Pace: "Speed kept", "速度达成率";
    PaceHelp: "Share of the asked speed that the engine reaches on this machine.", "引擎在本机上所达到的速度占要求速度的比例。";
    Conservation: "Conserved quantities: largest error so far", "守恒量：迄今最大误差";
    EnergyDrift: "Energy", "能量";
    EnergyDriftHelp: "|E − E₀| / |E₀|, the largest seen.", "|E − E₀| / |E₀| 的最大值。";
    MomentumDrift: "Momentum", "动量";
    MomentumDriftHelp: "|p − p₀| over the sum of |m v|, the largest seen.", "|p − p₀| 除以 |m v| 之和的最大值。";
    AngularMomentumDrift: "Angular momentum", "角动量";
    AngularMomentumDriftHelp: "|L − L₀| over its scale, the largest seen.", "|L − L₀| 与其尺度之比的最大值。";
    LargestOverlap: "Deepest overlap", "最大重叠";
    LargestOverlapHelp: "Overlap over the contact distance: rounding only, since no collision is missed.",
        "重叠量与接触距离之比：仅为舍入误差，没有漏掉的碰撞。";
    NotConserved: "not conserved here", "此处不守恒";
    Stability: "Stability of the time step", "时间步的稳定性";
    StabilityNumber: "Step × highest frequency", "步长 × 最高频率";
    StabilityHelp: "Velocity Verlet is stable below 2; accurate well below 1.", "速度 Verlet 法小于 2 时稳定；远小于 1 时才精确。";
    NoStep: "no fixed time step", "无固定时间步";
    Unstable: "{}: unstable", "{}：不稳定";
    Reproducibility: "Reproducibility", "可重复性";
    SameBits: "The same scenario and seed give the same bits: here, without a window, in a film, on one thread or many.",
        "相同的场景和种子给出逐位相同的结果：在此窗口、无窗口、影片中，单线程或多线程皆然。";
    SaveTable: "Save table: {}", "保存表格：{}";

    // Notebook.
    NotebookEmpty: "Record a row whenever a measurement is ready, change a parameter, and record the next. Two columns of three rows or more can be fitted with a line.",
        "测量完成后记录一行，改变一个参数，再记录下一行。三行以上的两列可以作直线拟合。";
    Columns: "Columns", "列";
    ClearRows: "Clear", "清空";
    RemoveRow: "Take away row {}", "删除第 {} 行";
    Fit: "Straight line", "直线拟合";
    FitNeeds: "A line needs two columns with three rows or more.", "拟合直线需要两列，且至少三行。";
    FitWeighted: "Weighted by the standard errors of the rows.", "按各行的标准误差加权。";
    FitByScatter: "Errors from the scatter about the line.", "误差由围绕直线的离散程度得出。";
    Abscissa: "x", "x";
    Ordinate: "y", "y";

    // Stage.
    PaintOwn: "by experiment", "按实验";
    PaintSpeed: "by speed", "按速率";
    PaintEnergy: "by energy", "按动能";
    PaintSpecies: "by species", "按种类";
    PaintCollisions: "by collisions", "按碰撞次数";
    PaintHeight: "by height", "按高度";
    PaintUnknown: "This experiment does not tell that of its bodies.", "此实验不提供这一信息。";
    Colouring: "Colours", "着色";
    PaintPlain: "all alike", "统一颜色";
    HoleWidth: "Hole, of the width", "孔宽占比";
    WallTemperature: "Wall kT; 0: none", "器壁 kT；0 为无";
    Disturbance: "ε", "ε";
    DisturbanceHelp: "Each velocity is turned by a random angle of about ε; energy stays. Disturb, then reverse: Loschmidt's question, how exact must the reversal be?",
        "每个速度转过约为 ε 的随机角度，能量不变。先扰动再反转，即洛施密特之问：反转须多精确？";
    Deeds: "Done by hand", "手动操作";
    DeedsHelp: "Going back before one of these undoes it; going on repeats it, bit for bit. What is measured counts only what no hand has touched.",
        "回到操作之前即撤销；再向前则逐位重复。测量只计未被触碰的系统。";
    DeedsOfFile: "Done by the file", "由文件执行";
    DeedsOfFileHelp: "These stand in the scenario file as [[deed]]; the run does them when their time comes.",
        "它们作为 [[deed]] 写在场景文件中；运行到该时刻时执行。";
    DidReverse: "reversed", "反转";
    DidDisturb: "disturbed, ε = {}", "扰动，ε = {}";
    DidPlace: "carried body {}", "搬动粒子 {}";
    DidThrow: "threw body {}", "抛掷粒子 {}";
    DidPartition: "put a partition in", "插入隔板";
    DidOpen: "opened the partitions", "打开隔板";
    DidHeat: "wall at kT = {}", "器壁 kT = {}";
    DidCool: "wall without a temperature", "器壁不再恒温";
    DidPush: "pushed the piston", "推动活塞";
    DidAdd: "added a body", "添加粒子";
    DidRemove: "took body {} away", "取走粒子 {}";
    Following: "Following body", "跟随粒子";
    Body: "Body", "粒子";
    Radius: "radius", "半径";
    Density: "density", "密度";
    Flow: "flow u", "流速 u";
    KineticPressure: "P, kinetic", "P（动理部分）";
    CollisionPressure: "P, of collisions", "P（碰撞部分）";
    WholePressure: "P", "P";
    ProbedFor: "{} collisions in t = {}", "{} 次碰撞，历时 t = {}";
    BackToChecks: "Back to the checks", "返回检验";
    ShowChart: "Show its chart", "显示其图表";
    ChiSquared: "χ² = {} in {} bins", "χ² = {}，{} 格";
    ChiSquaredHelp: "Sum over the bins with five counts or more of ((measured − theory) / error)²; of independent counts it is expected to be as large as their number, with the standard deviation √(2 × number).",
        "对计数不少于五的各格求和 ((测量 − 理论) / 误差)²；计数相互独立时其期望等于格数，标准差为 √(2 × 格数)。";
    BesideIt: "Beside it", "并列计算";
    Alone: "nothing", "无";
    BesideHelp: "The same system computed another way, from the same start, and how long the two agree.",
        "同一系统从同一初态用另一种方法计算，并显示两者一致多久。";
    AgreeUntil: "They agree to within a radius until t = {}", "两者在一个半径之内一致，直到 t = {}";
    AgreeYet: "They agree: largest distance {}", "两者一致：最大距离 {}";
    Preset: "Preset", "预设";
    PresetNone: "Choose…", "选择…";

    // Files.
    File: "File", "文件";
    Save: "Save", "保存";
    OpenHelp: "The name of a scenario file (.toml). A file can also be dropped onto the window.", "场景文件名（.toml）。也可以把文件拖放到窗口上。";
    SaveHelp: "What runs here is always a scenario file: `corpuscle run FILE` gives the same run.", "这里运行的始终是一个场景文件：`corpuscle run 文件` 给出同样的运行。";
    Saved: "saved: {}", "已保存：{}";
    RecordHelp: "Made beside the window by the same engine, picture by picture: .mp4, .gif, .png, or a folder.",
        "由同一引擎在窗口之外逐帧生成：.mp4、.gif、.png 或文件夹。";
    RecordNeeds: "A name and a stretch of time are needed; this run ends at {}.", "需要文件名和一段时间；本次运行在 {} 结束。";
    Recording: "recording {}", "正在录制 {}";
    Recorded: "recorded: {}", "录制完成：{}";
    RecordFailed: "not recorded: {}", "录制失败：{}";
    At: "Time", "时刻";
    From: "From t", "起始 t";
    Until: "Until t", "终止 t";
    Seconds: "Seconds of film", "影片秒数";
    Fps: "Pictures a second", "每秒帧数";
    Size: "Size in pixels", "像素尺寸";
    WithPanels: "With the panels", "包含面板";

    // Hints.
    HintPlay: "Space lets time pass or stops it. The curves on the right are measured as it passes, beside their theory.",
        "空格键播放或暂停。右侧曲线随时间实时测量，并与理论并列。";
    HintStage: "Turn the wheel to zoom, drag to move, click a particle to follow it.", "滚轮缩放，拖动平移，单击粒子即可跟随。";
    HintKeys: "Change a value on the left and the run starts again. The key ? lists everything else.", "在左侧修改数值会重新开始运行。按 ? 键查看全部功能。";
    HintNext: "Next", "下一条";
    HintDone: "Good", "知道了";
    HintNever: "No hints", "不再提示";

    // Faults.
    ThreadEnded: "The simulation has ended by a fault of the program: please report it with the lines on the terminal.",
        "模拟因程序错误而终止：请附上终端输出进行报告。";
}
