//! MP4: films in H.264.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use muxide::api::{Muxer, MuxerBuilder, MuxerError, VideoCodec};
use openh264::OpenH264API;
use openh264::encoder::{
    Encoder as H264, EncoderConfig, FrameRate, FrameType, IntraFramePeriod, QpRange, RateControlMode, UsageType, VuiConfig,
};
use openh264::formats::{RgbaSliceU8, YUVBuffer};

use super::{Encoder, no_picture, write_error};
use crate::{Picture, RenderError};

/// A film of constant quality: every picture is kept, however little changes.
pub(super) struct Mp4 {
    path: PathBuf,
    encoder: H264,
    muxer: Option<Muxer<BufWriter<File>>>,
    planes: YUVBuffer,
    size: [usize; 2],
    fps: f64,
    frames: u64,
}

impl Mp4 {
    pub(super) fn create(path: &Path, [width, height]: [u32; 2], fps: f64) -> Result<Self, RenderError> {
        let size = [width as usize, height as usize];
        let config = EncoderConfig::new()
            .skip_frames(false)
            .rate_control_mode(RateControlMode::Off)
            .qp(QpRange::new(18, 24))
            .max_frame_rate(FrameRate::from_hz(fps as f32))
            .intra_frame_period(IntraFramePeriod::from_num_frames((2.0 * fps).ceil().clamp(1.0, 600.0) as u32))
            .num_threads(1) // the same bytes on every machine
            .usage_type(UsageType::ScreenContentRealTime)
            // Neither exists for drawn content, and the encoder would say so on the terminal.
            .adaptive_quantization(false)
            .background_detection(false)
            // How `YUVBuffer` converts: ITU-R BT.601 in the limited range.
            .vui(VuiConfig::bt601());
        let encoder =
            H264::with_api_config(OpenH264API::from_source(), config).map_err(|fault| refused(path, &fault.to_string()))?;
        let file = File::create(path).map_err(|source| write_error(path, source))?;
        let muxer = MuxerBuilder::new(BufWriter::new(file))
            .video(VideoCodec::H264, width, height, fps)
            .build()
            .map_err(|fault| muxing_error(path, fault))?;
        let planes = YUVBuffer::new(size[0], size[1]);
        Ok(Self { path: path.to_owned(), encoder, muxer: Some(muxer), planes, size, fps, frames: 0 })
    }
}

impl Encoder for Mp4 {
    fn frame(&mut self, picture: &Picture) -> Result<(), RenderError> {
        self.planes.read_rgba8(RgbaSliceU8::new(&picture.rgba, (self.size[0], self.size[1])));
        let stream = self.encoder.encode(&self.planes).map_err(|fault| refused(&self.path, &fault.to_string()))?;
        let key = matches!(stream.frame_type(), FrameType::IDR | FrameType::I);
        let time = self.frames as f64 / self.fps;
        self.frames += 1;
        match &mut self.muxer {
            Some(muxer) => muxer.write_video(time, &stream.to_vec(), key).map_err(|fault| muxing_error(&self.path, fault)),
            None => Ok(()),
        }
    }

    fn finish(&mut self) -> Result<(), RenderError> {
        if self.frames == 0 {
            return Err(no_picture(&self.path));
        }
        let Some(mut muxer) = self.muxer.take() else { return Ok(()) };
        muxer.finish_in_place().map_err(|fault| muxing_error(&self.path, fault))?;
        // Dropping the buffer would hide a full disk.
        muxer.into_writer().flush().map_err(|source| write_error(&self.path, source))
    }
}

fn refused(path: &Path, words: &str) -> RenderError {
    RenderError::Clip { path: path.to_owned(), expected: format!("the video encoder refuses: {words}") }
}

fn muxing_error(path: &Path, fault: MuxerError) -> RenderError {
    match fault {
        MuxerError::Io(source) => write_error(path, source),
        fault => refused(path, &fault.to_string()),
    }
}
